#include "wavelet/coefficients.h"

#include <algorithm>
#include <cmath>

namespace relamp {

SparseCoefs sparsify(std::span<const float> dense, float energyFraction, size_t maxTerms) {
    std::vector<uint32_t> kept;
    double energy = 0;
    for (uint32_t k = 0; k < dense.size(); ++k) {
        if (dense[k] == 0) continue;
        kept.push_back(k);
        energy += double(dense[k]) * double(dense[k]);
    }
    const size_t most = maxTerms == 0 ? kept.size() : std::min(maxTerms, kept.size());
    if (energyFraction < 1 || most < kept.size()) {
        // A heap, because usually far fewer terms are taken than are there. Popped terms gather at the end.
        const auto smaller = [&](uint32_t a, uint32_t b) {
            const float x = std::abs(dense[a]), y = std::abs(dense[b]);
            return x != y ? x < y : a > b;
        };
        std::make_heap(kept.begin(), kept.end(), smaller);
        const double wanted = energyFraction < 1 ? double(energyFraction) * energy : 2 * energy;
        double taken = 0;
        auto rest = kept.end();
        while (rest != kept.begin() && size_t(kept.end() - rest) < most && taken < wanted) {
            std::pop_heap(kept.begin(), rest, smaller);
            --rest;
            taken += double(dense[*rest]) * double(dense[*rest]);
        }
        kept.erase(kept.begin(), rest);
        std::sort(kept.begin(), kept.end());
    }
    SparseCoefs coefs;
    coefs.value.reserve(kept.size());
    for (const uint32_t k : kept) coefs.value.push_back(dense[k]);
    coefs.index = std::move(kept);
    return coefs;
}

void scatter(const SparseCoefs& coefs, std::span<float> dense) {
    std::fill(dense.begin(), dense.end(), 0.0f);
    for (size_t t = 0; t < coefs.size(); ++t) dense[coefs.index[t]] = coefs.value[t];
}

float dot(const SparseCoefs& a, const SparseCoefs& b) {
    double sum = 0;
    for (size_t s = 0, t = 0; s < a.size() && t < b.size();) {
        if (a.index[s] < b.index[t]) {
            ++s;
        } else if (b.index[t] < a.index[s]) {
            ++t;
        } else {
            sum += double(a.value[s++]) * double(b.value[t++]);
        }
    }
    return float(sum);
}

float dot(const SparseCoefs& a, std::span<const float> dense) {
    double sum = 0;
    for (size_t t = 0; t < a.size(); ++t) sum += double(a.value[t]) * double(dense[a.index[t]]);
    return float(sum);
}

}  // namespace relamp
