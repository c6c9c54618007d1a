// Reflectance given the light, on matte surfaces: one albedo per vertex under the one prior of the house,
// edge-preserving on differences of log albedo. The prior does not care for the scale, so the data decide it
// (docs/method.md 6).
#pragma once
#include "base/progress.h"
#include "scene/scene.h"
#include "solve/gloss/matte.h"

namespace relamp {

struct AlbedoPrior {
    float step = 0.10f;  ///< standard deviation of the difference in log albedo across a mesh edge
    float edge = 0.15f;  ///< differences much larger than this count as edges and are not smoothed
    int iterations = 4;
    const std::vector<Rgb>* towards =
        nullptr;           ///< optional: per mesh vertex an albedo it is probably near to (solve/palette.h)
    float spread = 0.05f;  ///< standard deviation of log albedo about that; `edge` bends it too
};

struct AlbedoResult {
    std::vector<Rgb>
        albedo;  ///< per mesh vertex; vertices without light or observations are filled from their neighbours
    std::vector<float> confidence;  ///< fraction of its own observations in it, [0, 1]
};

/// `lit[i]` = irradiance / pi at observation i (what albedo 1 would show) and `litSigma[i]` its standard deviation
/// (shadow edges). Minimises sum (y - albedo x lit)^2 / sigma^2 + prior over log albedo by reweighted sparse Cholesky
/// solves: O(n) to O(n^1.5).
AlbedoResult solveAlbedo(const Scene& scene, const MatteObservations& matte, const std::vector<Rgb>& lit,
                         const std::vector<Rgb>& litSigma, const AlbedoPrior& prior, Progress& progress);

}  // namespace relamp
