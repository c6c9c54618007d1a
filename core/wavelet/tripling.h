// Product and triple product integrals in the Haar basis [Ng04]: tripling coefficients C_klm are known in closed form,
// so triple products walk the quadtree instead of the grid.
#pragma once
#include <cstdint>
#include <vector>

#include "wavelet/coefficients.h"

namespace relamp {

/// C_klm, the integral of the product of three basis functions, by their indices in the layout of haar.h.
/// Source: [Ng04] Haar tripling coefficient theorem. Non-zero only for (1) three scaling functions, (2) two identical
/// wavelets and the scaling function or a strict ancestor of level l: 2^l times its sign there, (3) the three different
/// wavelets of one square of level l: 2^l. All of it / sqrt(domainArea). `domainArea` = 4 pi for the sphere (functions
/// are then orthonormal per steradian).
float triplingCoefficient(uint32_t k, uint32_t l, uint32_t m, int side, float domainArea);

/// Sum over k, l, m of C_klm a_k b_l c_m: the integral of the product of three functions over the domain. Tree walk
/// with parent sums ([Ng04] section 5), O(non-zeros x log side), sums in double. Exact at full terms. Keeps 3 side^2
/// floats of scratch per thread. Throws Error when an index lies outside the square.
float tripleProduct(const SparseCoefs& a, const SparseCoefs& b, const SparseCoefs& c, int side, float domainArea);

/// Coefficients of the product of two functions (dense result, side^2 values). Multiplies on the grid, which is exact
/// because both are constant on its cells, and costs O(side^2) as filling the result does anyway.
std::vector<float> productCoefs(const SparseCoefs& a, const SparseCoefs& b, int side, float domainArea);

}  // namespace relamp
