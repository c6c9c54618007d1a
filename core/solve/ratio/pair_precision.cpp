#include "solve/ratio/pair_precision.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/parallel.h"
#include "base/statistics.h"

namespace relamp {
namespace {

constexpr float leastFraction = 0.005f;
/// Patterns of texture are larger than a pair, so errors of brightness go together from pair to pair, and a pair tells
/// less of it than its variance says; errors of hue are mostly noise and do not. Measured on captures with truth: 4 to
/// 10 is best for the scale and hue of all of them.
constexpr double togetherness = 4;
constexpr size_t leastPairs = 64;

/// Of the difference of channels c and d, by errors of single lights.
float ofHue(const PairVariance& v, int c, int d) {
    return v.hue[size_t(c)] + v.hue[size_t(d)] - 2 * v.hue[size_t(c + d + 2)];
}

}  // namespace

ChromaFraction chromaFraction(const std::vector<Rgb>& residual, const std::vector<PairVariance>& variance) {
    ChromaFraction fraction;
    if (residual.size() < 8 * leastPairs) return fraction;
    // Twice the variance of a channel's own error is that of the difference of two; a median of squares is 0.455 of
    // their mean.
    struct Entry {
        float noise, model, hue, square;
    };
    std::vector<Entry> entries(3 * residual.size());
    parallelFor(residual.size(), 4096, [&](size_t k) {
        const Rgb r = residual[k], n = variance[k].noise, m = variance[k].model;
        for (int c = 0; c < 3; ++c) {
            const int d = (c + 1) % 3;
            const float difference = r[c] - r[d];
            entries[3 * k + size_t(c)] = {n[c] + n[d], m[c] + m[d], ofHue(variance[k], c, d),
                                          difference * difference / 0.455f};
        }
    });
    // Eight bins of equal size by noise, by halving thrice.
    constexpr size_t bins = 8;
    const auto edge = [&](size_t bin) { return entries.begin() + std::ptrdiff_t(bin * entries.size() / bins); };
    for (size_t width = bins; width > 1; width /= 2)
        parallelFor(bins / width, 1, [&](size_t part) {
            const size_t from = part * width;
            std::nth_element(edge(from), edge(from + width / 2), edge(from + width),
                             [](const Entry& a, const Entry& b) { return a.noise < b.noise; });
        });
    std::array<float, bins> noise{};
    parallelFor(bins, 1, [&](size_t bin) {
        std::vector<float> some;
        for (auto e = edge(bin); e != edge(bin + 1); ++e) some.push_back(e->square / e->noise);
        noise[bin] = medianOf(std::move(some));
    });
    fraction.noise = std::clamp(*std::min_element(noise.begin(), noise.end()), leastFraction, 1.0f);
    std::vector<float> model(entries.size());
    parallelFor(entries.size(), 8192, [&](size_t i) {
        model[i] =
            std::max(0.0f, entries[i].square - entries[i].hue - fraction.noise * entries[i].noise) / entries[i].model;
    });
    fraction.model = std::clamp(medianOf(std::move(model)), leastFraction, 1.0f);
    return fraction;
}

PairPrecision pairPrecision(const PairVariance& variance, const ChromaFraction& fraction) {
    glm::dmat3 covariance(0);
    glm::dvec3 common(0);
    for (int c = 0; c < 3; ++c) {
        const double all = double(variance.noise[c]) + variance.model[c];
        const double own =
            fraction.apart()
                ? all
                : (double(fraction.noise) * variance.noise[c] + double(fraction.model) * variance.model[c]) /
                      togetherness;
        covariance[c][c] = own;
        common[c] = std::sqrt((all - own) / 3);
    }
    covariance += glm::outerProduct(common, common);
    for (int c = 0; c < 3 && !fraction.apart(); ++c)
        for (int d = 0; d < 3; ++d) covariance[c][d] += double(variance.hue[size_t(c == d ? c : c + d + 2)]);
    const glm::dmat3 p = glm::inverse(covariance);
    return {float(p[0][0]), float(p[1][1]), float(p[2][2]), float(p[1][0]), float(p[2][0]), float(p[2][1])};
}

}  // namespace relamp
