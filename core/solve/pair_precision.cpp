#include "solve/pair_precision.h"

#include <algorithm>
#include <cmath>

namespace relamp {
namespace {

constexpr float leastShare = 0.005f;
/// Patterns of texture are larger than a pair, so errors of brightness go together from pair to pair, and a pair tells less of it than its variance
/// says; errors of hue are mostly noise and do not. Measured on captures with truth: 4 to 10 is best for the scale and hue of all of them.
constexpr double togetherness = 4;
constexpr size_t leastPairs = 64;

float medianOf(std::vector<float>& v) {
    const size_t k = v.size() / 2;
    std::nth_element(v.begin(), v.begin() + std::ptrdiff_t(k), v.end());
    return v[k];
}

}  // namespace

ChromaShare chromaShare(const std::vector<Rgb>& residual, const std::vector<PairVariance>& variance) {
    ChromaShare share;
    if (residual.size() < 8 * leastPairs) return share;
    // Twice the variance of a channel's own error is that of the difference of two; a median of squares is 0.455 of their mean.
    struct Entry {
        float noise, model, square;
    };
    std::vector<Entry> entries;
    for (size_t k = 0; k < residual.size(); ++k) {
        const Rgb r = residual[k], n = variance[k].noise, m = variance[k].model;
        for (int c = 0; c < 3; ++c) {
            const int d = (c + 1) % 3;
            const float difference = r[c] - r[d];
            entries.push_back({n[c] + n[d], m[c] + m[d], difference * difference / 0.455f});
        }
    }
    std::sort(entries.begin(), entries.end(), [](const Entry& a, const Entry& b) { return a.noise < b.noise; });
    constexpr size_t bins = 8;
    float noise = 1;
    std::vector<float> some;
    for (size_t bin = 0; bin < bins; ++bin) {
        some.clear();
        for (size_t i = bin * entries.size() / bins; i < (bin + 1) * entries.size() / bins; ++i) some.push_back(entries[i].square / entries[i].noise);
        noise = std::min(noise, medianOf(some));
    }
    share.noise = std::clamp(noise, leastShare, 1.0f);
    some.clear();
    for (const Entry& e : entries) some.push_back(std::max(0.0f, e.square - share.noise * e.noise) / e.model);
    share.model = std::clamp(medianOf(some), leastShare, 1.0f);
    return share;
}

PairPrecision pairPrecision(const PairVariance& variance, const ChromaShare& share) {
    // Sherman-Morrison for diag(own) + u u'.
    double inverse[3], d[3], norm = 1;
    for (int c = 0; c < 3; ++c) {
        const double all = double(variance.noise[c]) + variance.model[c];
        const double own = share.apart() ? all : (double(share.noise) * variance.noise[c] + double(share.model) * variance.model[c]) / togetherness;
        const double common = (all - own) / 3;
        inverse[c] = 1 / own;
        d[c] = std::sqrt(common) * inverse[c];
        norm += common * inverse[c];
    }
    const auto entry = [&](int c, int e) { return float((c == e ? inverse[c] : 0.0) - d[c] * d[e] / norm); };
    return {entry(0, 0), entry(1, 1), entry(2, 2), entry(0, 1), entry(0, 2), entry(1, 2)};
}

}  // namespace relamp
