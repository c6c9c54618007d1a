// Fits of light with one point emitter more, on a few thousand pairs of points: the inner part of findHiddenLight. Not
// a door.
#pragma once
#include <Eigen/Core>

#include "capture/emission_lobe.h"
#include "solve/priors/anchors.h"
#include "solve/priors/light_prior.h"
#include "solve/ratio/pairs.h"

namespace relamp {

/// The points and pairs looked at, and what light the environment and the known emitters can give them. Luminance only.
struct UnobservedLightData {
    std::vector<Vec3> positions, normals;  ///< of the points
    std::vector<double> radiance;
    std::vector<AlbedoPair> pairs;    ///< of places in these lists
    std::vector<double> variance;     ///< of each pair's relative difference: noise, and 1.5 % of model error a point
    std::vector<uint32_t> component;  ///< of each pair: of the mesh
    std::vector<uint8_t> far;         ///< of each pair: 1 when its points lie far apart on one component
    std::vector<int> part;            ///< of each pair: one of `parts` boxes of the scene
    int parts = 0;
    Eigen::MatrixXd rows;  ///< points x (leaves, emitters): radiance of a white matte point
    LightLeaves leaves;
    LightAnchors anchors;
    LightPriorOptions prior;
    Eigen::VectorXd start;  ///< a first guess of the light
    bool anchored = false;  ///< some light is seen directly
};

UnobservedLightData unobservedLightData(const Scene& scene, const RadianceSamples& samples,
                                        const EmitterClusters& clusters, int level, size_t pairs, uint64_t seed,
                                        Progress& progress);

/// What an emitter is besides its place.
struct LightShape {
    EmissionLobe lobe{};
    float radius = 0;  ///< metres: shadows have soft edges; 0: two hundredths of the distance
};

/// What a point emitter at `place` gives each point, with shadows: `rays` to a ball about it, or one to the place
/// itself when 0.
Eigen::VectorXd pointLightColumn(const Scene& scene, const UnobservedLightData& data, const Vec3& place, int rays,
                                 const LightShape& shape = {});

struct UnobservedLightFit {
    Eigen::VectorXd light;   ///< leaves, emitters, and the emitter looked for if there is one
    Eigen::VectorXd column;  ///< its column; empty without
    Vec3 place{0};
    LightShape shape{};
    double misfit = 0;    ///< robust, mean over the pairs, in variances
    double fraction = 0;  ///< of the light on the points that comes from the emitter
};

/// An emitter at a place that is given joins the known ones; how bright it is, is not known.
void addKnownPlace(const Scene& scene, const Vec3& place, const LightShape& shape, UnobservedLightData& data);

/// Widens the pairs' variances, those of each component of the mesh by a factor, to what is left of its near pairs
/// under a fit: texture and errors of the mesh. Near pairs speak for far ones, because half of those may span the very
/// shadows that the fit does not know.
void assessPairs(UnobservedLightData& data, const UnobservedLightFit& fit);

/// Gauss-Newton on the pairs' relative differences, light not negative. `column` may be null; `start` empty: a first
/// guess.
UnobservedLightFit fitUnobservedLight(const UnobservedLightData& data, const Eigen::VectorXd* column,
                                      const Eigen::VectorXd& start, int iterations);
/// The best place about `first`, by trying 14 others about the best so far at a step that halves, from `reach` to
/// `least` (fractions of the distance from `middle`, angle and logarithm of distance alike; `sideways`: the distance
/// stays): a shadow's edge moves in jumps that no derivative knows.
UnobservedLightFit searchAround(const Scene& scene, const UnobservedLightData& data, const Vec3& first,
                                const Vec3& middle, const Eigen::VectorXd& start, float reach, float least,
                                bool sideways, Progress& progress, const LightShape& shape = {});
/// The best axis for an emitter at `place` whose radiance is a power of the cosine to it: what a power of 1 needs,
/// which is linear in the axis, improved by trying others about it. Power and radius stay.
UnobservedLightFit aimedLight(const Scene& scene, const UnobservedLightData& data, const Vec3& place, float power,
                              float radius, const Eigen::VectorXd& start);
/// Light and place together, from `place` on.
UnobservedLightFit refineUnobservedLight(const Scene& scene, const UnobservedLightData& data, const Vec3& place,
                                         const Eigen::VectorXd& start, int iterations, Progress& progress);
/// Of the place found, square metres: the scatter of the best of some 140 places about it (and of `more`) when the
/// parts of the scene are drawn anew with repetition, 200 times (a bootstrap). Shadows' edges take part in it, as they
/// do not in a curvature. `best` moves when one of the places is better.
glm::dmat3 positionCovariance(const Scene& scene, const UnobservedLightData& data, const Vec3& middle,
                              const std::vector<Vec3>& more, uint64_t seed, UnobservedLightFit& best,
                              Progress& progress);
/// By how many standard errors, counted over the parts, the misfit of `with` is less.
double gainCertainty(const UnobservedLightData& data, const UnobservedLightFit& without,
                     const UnobservedLightFit& with);

}  // namespace relamp
