#include "solve/ratio/hue_errors.h"

#include <algorithm>

#include "base/math.h"
#include "base/parallel.h"
#include "solve/ratio/pair_gram.h"

namespace relamp {

std::vector<std::array<float, 6>> hueErrors(const InfluenceRows& influence, size_t leaves,
                                            const std::array<Eigen::VectorXd, 3>& light,
                                            const std::array<Eigen::VectorXf, 3>& irradiance, float error) {
    std::vector<std::array<float, 6>> all(influence.rows);
    parallelFor(influence.rows, 1024, [&](size_t i) {
        std::array<float, 6> sum{};
        const auto add = [&](const Rgb& part) {
            for (size_t b = 0; b < sum.size(); ++b) {
                const auto [c, d] = ChannelWeights::blocks[b];
                sum[b] += error * error * part[c] * part[d];
            }
        };
        Rgb others(0);
        for (size_t k = leaves; k < influence.columns; ++k) {
            Rgb part(0);
            for (int c = 0; c < 3; ++c)
                part[c] = influence.row(i)[k] * float(light[size_t(c)](Eigen::Index(k))) /
                          std::max(1e-20f, irradiance[size_t(c)](Eigen::Index(i)));
            part -= Rgb((part.x + part.y + part.z) / 3);
            others -= part;
            add(part);
        }
        add(others);
        all[i] = sum;
    });
    return all;
}

}  // namespace relamp
