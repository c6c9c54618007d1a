// What the photographs say of matte points, and which of them probably have one albedo.
#pragma once
#include "solve/ratio/pairs.h"
#include "solve/state/solve_input.h"

namespace relamp {

struct SolveObservations {
    MatteObservations matte;
    MatteObservations withCoatings;  ///< the same as photographed, where what coatings reflect was taken off; or empty
    std::vector<AlbedoPair> pairs;
    double matteFraction = 0;  ///< of the observations that are not of metals
    float darkness = 0;        ///< radiance below which nothing tells: a thousandth of the bright ones

    /// `skip`: per vertex 1 where an emitter lies. `noMetals`: RatioObservations::noMetals. What the plan computed of
    /// the same is taken over from `planned`, which may be null.
    static SolveObservations of(const SolveInput& in, std::vector<uint8_t> skip, bool noMetals,
                                const RatioObservations* planned);
    /// Enough of the surface has a matte signal for the albedo-free start.
    bool hasMatte() const { return matteFraction > 0.15; }
    /// The observations as photographed are kept before the first change.
    void keepAsPhotographed();
    void backToPhotographed();
    /// What changes with the view and not as a lobe does differs by geometry or exposure: the median of the views tells
    /// it, not their darker quarter. `components`: per connected component 1 where that is so.
    void readAsMatte(const SolveInput& in, const std::vector<uint8_t>& components);
};

}  // namespace relamp
