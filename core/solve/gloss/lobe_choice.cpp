#include "solve/gloss/lobe_choice.h"

#include <array>
#include <limits>

#include "base/parallel.h"
#include "brdf/projection.h"

namespace relamp {

namespace {

/// The normal equations of one channel, the Lambert part of each vertex eliminated.
struct Equations {
    std::vector<double> gram, moment;
    double size = 0;
    double objective(const std::vector<double>& x) const {
        const size_t n = moment.size();
        double sum = size;
        for (size_t k = 0; k < n; ++k) {
            if (x[k] == 0) continue;
            double row = 0;
            for (size_t j = 0; j < n; ++j) row += gram[k * n + j] * x[j];
            sum += x[k] * (row - 2 * moment[k]);
        }
        return std::max(0.0, sum);
    }
};

}  // namespace

std::vector<LobeChoice> chooseLobes(const std::vector<Lobe>& lobes, const std::vector<std::vector<Rgb>>& responses,
                                    const std::vector<GlossyObservation>& observations, bool withLambert,
                                    size_t mostLobes) {
    const size_t n = lobes.size(), count = observations.size();
    const std::vector<size_t> starts = startsOfVertices(observations);
    std::vector<float> robust(count, 1);
    std::vector<LobeChoice> choices;
    constexpr int rounds = 3;
    for (int round = 0; round < rounds; ++round) {
        std::array<Equations, 3> channels;
        parallelFor(3, 1, [&](size_t c) {
            Equations& q = channels[c];
            q.gram.assign(n * n, 0);
            q.moment.assign(n, 0);
            std::vector<double> mean(n), left(n);
            for (size_t g = 0; g + 1 < starts.size(); ++g) {
                std::fill(mean.begin(), mean.end(), 0.0);
                double meanY = 0, weight = 0;
                const auto weightOf = [&](size_t i) {
                    return double(robust[i]) / (double(observations[i].sigma) * double(observations[i].sigma));
                };
                if (withLambert) {
                    for (size_t i = starts[g]; i < starts[g + 1]; ++i) {
                        const double w = weightOf(i);
                        for (size_t k = 1; k < n; ++k) mean[k] += w * double(responses[k][i][int(c)]);
                        meanY += w * double(observations[i].radiance[int(c)]);
                        weight += w;
                    }
                    for (double& m : mean) m /= weight;
                    meanY /= weight;
                }
                for (size_t i = starts[g]; i < starts[g + 1]; ++i) {
                    const double w = weightOf(i), y = double(observations[i].radiance[int(c)]) - meanY;
                    for (size_t k = 1; k < n; ++k) left[k] = double(responses[k][i][int(c)]) - mean[k];
                    for (size_t k = 1; k < n; ++k) {
                        q.moment[k] += w * left[k] * y;
                        for (size_t j = 1; j <= k; ++j) q.gram[k * n + j] += w * left[k] * left[j];
                    }
                    q.size += w * y * y;
                }
            }
            for (size_t k = 1; k < n; ++k)
                for (size_t j = 1; j < k; ++j) q.gram[j * n + k] = q.gram[k * n + j];
        });
        choices.clear();
        std::vector<size_t> allowed;
        std::array<std::vector<double>, 3> weights;
        while (allowed.size() < std::min(mostLobes, n - 1)) {
            std::vector<double> error(n, std::numeric_limits<double>::infinity());
            parallelFor(n - 1, 1, [&](size_t i) {
                const size_t k = i + 1;
                if (std::find(allowed.begin(), allowed.end(), k) != allowed.end()) return;
                std::vector<size_t> tried = allowed;
                tried.push_back(k);
                error[k] = 0;
                for (const Equations& q : channels)
                    error[k] += q.objective(nonNegativeLeastSquares(q.gram, q.moment, tried));
            });
            allowed.push_back(size_t(std::min_element(error.begin(), error.end()) - error.begin()));
            Lobe mixture{Lobe::Kind::mixture, 1, ""};
            float largest = 0;
            for (size_t c = 0; c < 3; ++c)
                weights[c] = nonNegativeLeastSquares(channels[c].gram, channels[c].moment, allowed);
            for (const size_t k : allowed) {
                const float fraction = float(weights[0][k] + weights[1][k] + weights[2][k]);
                if (!(fraction > 0)) continue;
                mixture.parts.push_back(lobes[k]);
                mixture.parts.back().fraction = fraction;
                if (fraction > largest) {
                    largest = fraction;
                    mixture.alpha = lobes[k].alpha;
                }
                mixture.name += (mixture.name.empty() ? "" : " + ") + lobes[k].name;
            }
            if (mixture.parts.size() < allowed.size()) break;  // the last one adds nothing
            for (Lobe& part : mixture.parts) part.fraction /= largest;
            choices.push_back({mixture.parts.size() == 1 ? mixture.parts[0] : mixture, error[allowed.back()]});
        }
        if (choices.empty() || round + 1 == rounds) break;
        // Outliers of the best mixture count little in the next round.
        for (size_t g = 0; g + 1 < starts.size(); ++g) {
            std::array<double, 3> matte{};
            std::vector<Rgb> left(starts[g + 1] - starts[g]);
            for (int c = 0; c < 3; ++c) {
                double sum = 0, weight = 0;
                for (size_t i = starts[g]; i < starts[g + 1]; ++i) {
                    double y = double(observations[i].radiance[c]);
                    for (size_t k = 1; k < n; ++k)
                        if (weights[size_t(c)][k] > 0) y -= weights[size_t(c)][k] * double(responses[k][i][c]);
                    left[i - starts[g]][c] = float(y);
                    const double w =
                        double(robust[i]) / (double(observations[i].sigma) * double(observations[i].sigma));
                    sum += w * y;
                    weight += w;
                }
                if (withLambert) matte[size_t(c)] = sum / weight;
            }
            for (size_t i = starts[g]; i < starts[g + 1]; ++i) {
                const Rgb r = left[i - starts[g]] - Rgb(matte[0], matte[1], matte[2]);
                robust[i] = 1 / (1 + glm::dot(r, r) / (3 * observations[i].sigma * observations[i].sigma) / 16);
            }
        }
    }
    return choices;
}

}  // namespace relamp
