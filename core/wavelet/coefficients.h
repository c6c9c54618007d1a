// A sparse vector of Haar coefficients: index and value, sorted by index.
#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace relamp {

struct SparseCoefs {
    std::vector<uint32_t> index;  ///< ascending, each once, in the layout of haar.h
    std::vector<float> value;
    size_t size() const { return index.size(); }
};

/// The largest coefficients in magnitude that keep `energyFraction` of the squared norm (at most `maxTerms`, 0 = no
/// cap). energyFraction 1 keeps every non-zero. Of equal magnitudes the lower index is kept first.
SparseCoefs sparsify(std::span<const float> dense, float energyFraction = 1.0f, size_t maxTerms = 0);
/// Fills `dense` with the coefficients; 0 where there is none.
void scatter(const SparseCoefs& coefs, std::span<float> dense);
/// Double product integral: sum of products at equal indices.
float dot(const SparseCoefs& a, const SparseCoefs& b);
float dot(const SparseCoefs& a, std::span<const float> dense);

}  // namespace relamp
