// Fits of light with one point lamp more, on a few thousand pairs of points: the inner part of findHiddenLight. Not a door.
#pragma once
#include <Eigen/Core>

#include "solve/anchors.h"
#include "solve/light_prior.h"
#include "solve/pairs.h"

namespace relamp {

/// The points and pairs looked at, and what light the surroundings and the known lamps can give them. Luminance only.
struct HiddenLightData {
    std::vector<Vec3> positions, normals;  ///< of the points
    std::vector<double> radiance;
    std::vector<AlbedoPair> pairs;         ///< of places in these lists
    std::vector<double> variance;          ///< of each pair's relative difference: noise, and 1.5 % of model error a point
    std::vector<int> part;                 ///< of each pair: one of `parts` boxes of the scene
    int parts = 0;
    Eigen::MatrixXd rows;                  ///< points x (leaves, lamps): radiance of a white matte point
    LightLeaves leaves;
    LightAnchors anchors;
    LightPriorOptions prior;
    Eigen::VectorXd start;                 ///< a first guess of the light
    bool anchored = false;                 ///< some light is seen directly
};

HiddenLightData hiddenLightData(const Scene& scene, const RadianceSamples& samples, const EmitterClusters& clusters, int level, size_t pairs, uint64_t seed, Progress& progress);

/// What a point lamp at `place` gives each point, with shadows: `rays` to a small ball about it, or one to the place itself when 0.
Eigen::VectorXd pointLightColumn(const Scene& scene, const HiddenLightData& data, const Vec3& place, int rays);

struct HiddenLightFit {
    Eigen::VectorXd light;   ///< leaves, lamps, and the lamp looked for if there is one
    Eigen::VectorXd column;  ///< its column; empty without
    Vec3 place{0};
    double misfit = 0;       ///< robust, mean over the pairs, in variances
    double share = 0;        ///< of the light on the points that comes from the lamp
};

/// Gauss-Newton on the pairs' relative differences, light not negative. `column` may be null; `start` empty: a first guess.
HiddenLightFit fitHiddenLight(const HiddenLightData& data, const Eigen::VectorXd* column, const Eigen::VectorXd& start, int iterations);
/// Light and place together, from `place` on.
HiddenLightFit refineHiddenLight(const Scene& scene, const HiddenLightData& data, const Vec3& place, const Eigen::VectorXd& start, int iterations, Progress& progress);
/// Of the place found: inverse curvature around the gradients' scatter over the parts (a sandwich), square metres.
glm::dmat3 positionCovariance(const HiddenLightData& data, const HiddenLightFit& fit);
/// By how many standard errors, counted over the parts, the misfit of `with` is less.
double gainCertainty(const HiddenLightData& data, const HiddenLightFit& without, const HiddenLightFit& with);

}  // namespace relamp
