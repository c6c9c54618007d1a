// Measured materials as tables of numbers in the user's own folder; none of them are part of this repository.
#pragma once
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "base/error.h"
#include "brdf/merl.h"
#include "brdf/projection.h"

namespace relamp::bench {

using Rows = std::map<std::string, std::vector<double>>;

inline Rows readTable(const std::string& file) {
    std::ifstream in(file);
    if (!in) throw Error("{}: cannot be read", file);
    Rows rows;
    for (std::string line; std::getline(in, line);) {
        if (line.empty() || line[0] == '#' || line.rfind("material", 0) == 0) continue;
        std::istringstream words(line);
        std::string name, word;
        std::getline(words, name, ',');
        while (std::getline(words, word, ',')) rows[name].push_back(std::stod(word));
    }
    return rows;
}

/// A network of 6, 21, 21 and 3 units [Sztrajman21].
inline BrdfFunction network(const std::vector<double>& w) {
    return [&w](const Vec3& light, const Vec3& eye) {
        const HalfAngles a = halfAngles(light, eye);
        const double x[6] = {std::sin(a.half),
                             0,
                             std::cos(a.half),
                             std::sin(a.difference) * std::cos(a.azimuth),
                             std::sin(a.difference) * std::sin(a.azimuth),
                             std::cos(a.difference)};
        double first[21], second[21];
        for (int u = 0; u < 21; ++u) {
            double sum = w[size_t(126 + u)];
            for (int i = 0; i < 6; ++i) sum += x[i] * w[size_t(i * 21 + u)];
            first[u] = std::max(0.0, sum);
        }
        for (int u = 0; u < 21; ++u) {
            double sum = w[size_t(147 + 441 + u)];
            for (int i = 0; i < 21; ++i) sum += first[i] * w[size_t(147 + i * 21 + u)];
            second[u] = std::max(0.0, sum);
        }
        Rgb out;
        for (int c = 0; c < 3; ++c) {
            double sum = w[size_t(609 + 63 + c)];
            for (int i = 0; i < 21; ++i) sum += second[i] * w[size_t(609 + i * 3 + c)];
            out[c] = float(std::max(0.0, std::exp(sum) - 1));
        }
        return out;
    };
}

}  // namespace relamp::bench
