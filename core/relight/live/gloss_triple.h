// Glossy light of the environment by triple products in the Haar basis [Ng04]: lighting, visibility and reflectance
// each keep their largest coefficients, the sum over C_klm walks their trees. Exact on the grid at full terms. The
// viewport takes taps (live_gloss_taps.h), which are faster at equal error (tests/bench/PRT.md): [Ng04] has the
// reflectance of every normal and eye in a table, ours is put on the grid vertex by vertex.
#pragma once
#include <array>

#include "relight/live/gloss_taps.h"
#include "wavelet/coefficients.h"

namespace relamp {

/// How many coefficients each factor keeps, the largest ones; 0: all.
struct TripleTerms {
    size_t environment = 0, visibility = 0, reflectance = 0;
};

class TripleGloss {
public:
    /// Works on the quarters of `grid`: a square of twice its side.
    TripleGloss(const LiveGrid& grid, const DistantLight& distant, const TripleTerms& terms);
    int side() const { return side_; }
    /// Visibility from the masks of one vertex.
    SparseCoefs visibility(const uint8_t* masks) const;
    /// A lobe x cosine towards the unit direction `eye` (in the frame of the normal), at the middles of cells. Cost: 4
    /// side^2 evaluations.
    SparseCoefs reflectance(const Lobe& lobe, const Mat3& toWorld, const Vec3& eye) const;
    /// Integral of the three, per channel. Cost: about 20 ns a coefficient.
    Rgb light(const SparseCoefs& visibility, const SparseCoefs& reflectance) const;
    /// The same integral of all lobes cell by cell: brute force on the grid, and what full terms must give.
    Rgb onGrid(const BrdfBasis& basis, std::span<const LobeWeight> lobes, const Mat3& toWorld, const Vec3& eye,
               const uint8_t* masks) const;

private:
    const LiveGrid& grid_;
    TripleTerms terms_;
    int side_;
    std::vector<Rgb> cells_;  // mean radiance of each cell of the fine square
    std::array<SparseCoefs, 3> environment_;
    size_t quarterOf(int cell) const;  // LiveGrid's number of a cell of the fine square
};

}  // namespace relamp
