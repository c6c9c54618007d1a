// What the views say of each vertex's matte radiance, and how much of it depends on the view.
#pragma once
#include "radiance/samples.h"
#include "scene/scene.h"

namespace relamp {

/// One matte observation per usable vertex, or with several lighting states one per vertex and state: lists of equal
/// length.
struct MatteObservations {
    std::vector<uint32_t> vertices;  ///< ascending, in each lighting state
    std::vector<Rgb> radiance;       ///< robust mean over views (lower quantile where the surface is glossy)
    std::vector<Rgb> sigma;          ///< its standard deviation
    std::vector<float>
        viewSpread;  ///< per material (Scene::material): median relative spread between views, 0 with one view
    std::vector<uint8_t>
        componentGlossy;  ///< per material: 0 matte, 1 coated (matte under gloss), 2 no matte signal (metal)
    /// Observations of lighting state s are stateStart[s] ... stateStart[s + 1] - 1; empty: there is one state.
    std::vector<uint32_t> stateStart = {};

    size_t states() const { return stateStart.empty() ? 1 : stateStart.size() - 1; }
    size_t beginOf(size_t state) const { return stateStart.empty() ? 0 : stateStart[state]; }
    size_t endOf(size_t state) const { return stateStart.empty() ? vertices.size() : stateStart[state + 1]; }
    /// The state of observation i.
    size_t stateOf(size_t i) const;
    /// The observations of one state.
    MatteObservations inState(size_t state) const;
};

/// One look at a vertex in one channel.
struct MatteObservation {
    float radiance = 0, weight = 1, sigma = 0;  ///< sigma: standard deviation of an observation of weight 1
};
struct MatteValue {
    float radiance = 0, sigma = 0;
};
/// Mean of the observations about their weighted quantile, within three deviations or 6 % of it. A quantile below 0.5
/// is nearer to the median by what noise explains of the spread between quartiles. Sorts `observations`, which must not
/// be empty. O(n log n).
MatteValue robustMatteValue(std::vector<MatteObservation>& observations, float quantile);

/// `skip[v]` non-zero leaves vertex v out (emitters). Views of several lighting states are read state by state.
/// `componentGlossy`, if not null, is taken for MatteObservations::componentGlossy instead of what the differences
/// between views suggest.
MatteObservations matteObservations(const Scene& scene, const RadianceSamples& samples,
                                    const std::vector<uint8_t>& skip,
                                    const std::vector<uint8_t>* componentGlossy = nullptr);

/// Is the background black? Its brightest seen cell over the middle brightness of the surfaces; -1 where less than a
/// hundredth of it is seen. `inexact`: rims of surfaces that the mesh lacks are background too. Cells that are no
/// brighter than surfaces are then left aside, up to a twentieth of those seen.
double backgroundOverSurfaces(const RadianceSamples& samples, const MatteObservations& matte, bool inexact = false);

/// Observations on each material.
std::vector<size_t> observationsOfComponents(const Scene& scene, const MatteObservations& matte);

}  // namespace relamp
