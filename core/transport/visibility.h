// Which distant directions each vertex sees: one bit a direction cell, lossless and smaller than its coefficients.
#pragma once
#include <span>

#include "base/progress.h"
#include "image/direction_grid.h"
#include "scene/scene.h"
#include "wavelet/coefficients.h"

namespace relamp {

/// V(v, w) = 1 where the ray from vertex v along w leaves the scene. Bits of vertex v: words
/// bits[v * wordsPerVertex] ...; cells below the horizon of the shading normal are 0.
struct Visibility {
    DirectionGrid grid;
    int step = 1;          ///< one ray answers for step x step cells
    bool agreeing = true;  ///< false: cells amid coarse ones that agree have taken over their answer without a ray
    size_t wordsPerVertex = 0;
    std::vector<uint64_t> bits;
    bool sees(uint32_t vertex, int cell) const {
        return bits[vertex * wordsPerVertex + size_t(cell) / 64] >> (cell % 64) & 1;
    }
};

struct VisibilityOptions {
    int gridSide = 64;  ///< one ray through each cell's centre; 64 halves the error at contact shadows against 32
    const std::vector<uint8_t>* only =
        nullptr;   ///< per vertex: 0 leaves it out, it then sees nothing; null: every vertex
    int step = 1;  ///< a power of two: one ray for step x step cells
    /// false: at step 1 a ray is only traced where a lattice of one ray for 2 x 2 cells finds an edge: where the 3 x 3
    /// of them around a cell are not all open or all blocked. What is missed is thinner than 3 cells and lies between
    /// the lattice's rays.
    bool agreeing = true;
    Mat3 axes{1};  ///< of the square (DirectionGrid::axes)
};

/// Cost: gridSide^2 / step^2 / 2 rays a vertex in packets of 8, 10-18 million rays a second a core; without agreeing
/// ones a third to a half of that. Needs gridSide^2 / 8 bytes a vertex. The bits of a vertex rest on the options alone,
/// not on how it came to them.
Visibility computeVisibility(const Scene& scene, const VisibilityOptions& options, Progress& progress);
/// Fills in the vertices that `only` marks. Returns the rays it traced.
size_t addVisibility(const Scene& scene, const std::vector<uint8_t>& only, Visibility& visibility, Progress& progress);
/// From `visibility.step` down to a finer `step`, for the vertices that `only` marks; those rays that were traced are
/// not traced again.
size_t refineVisibility(const Scene& scene, const std::vector<uint8_t>& only, int step, bool agreeing,
                        Visibility& visibility, Progress& progress);

/// Directions that are wanted finer than the rest: `side` x `side` cells from (x, y), one ray for `step` x `step` of
/// them (powers of two, blocks in their own raster).
struct FinerDirections {
    int x = 0, y = 0, side = 1, step = 1;
};
/// Traces those directions anew, for the vertices that `only` marks. The visibility's own `step` is left as it is: a
/// pass of refineVisibility that is coarser than these blocks forgets them, one to step 1 needs them no more. Returns
/// the rays it traced.
size_t traceFiner(const Scene& scene, const std::vector<uint8_t>& only, const std::vector<FinerDirections>& blocks,
                  Visibility& visibility, Progress& progress);

/// Where rays from a vertex start: stepped off the surface along its normal.
Vec3 rayOrigin(const Scene& scene, const Vec3& position, const Vec3& normal);

/// Haar coefficients of V x max(0, n.w): what a Lambert surface takes from the environment. `energyFraction` as in
/// sparsify.
SparseCoefs visibilityCosineCoefs(const Scene& scene, const Visibility& visibility, uint32_t vertex,
                                  float energyFraction);
/// Haar coefficients of V alone.
SparseCoefs visibilityCoefs(const Visibility& visibility, uint32_t vertex, float energyFraction);

}  // namespace relamp
