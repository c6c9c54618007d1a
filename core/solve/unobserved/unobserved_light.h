// An emitter that no photograph shows and no mesh holds, found by what it does: shading that falls off with distance,
// and shadows.
#pragma once
#include <optional>
#include <string>

#include "base/progress.h"
#include "capture/capture.h"
#include "clusters/emitter_clusters.h"
#include "radiance/samples.h"
#include "scene/scene.h"

namespace relamp {

struct UnobservedLightOptions {
    uint64_t seed = 1;
    size_t pairs = 5000;          ///< of points of probably equal albedo, looked at while places are compared
    size_t finalPairs = 20000;    ///< and for the answer
    float leastGain = 0.05f;      ///< fraction of the misfit that an emitter must explain to be taken for real
    float leastFraction = 0.05f;  ///< of the light on the surfaces that it must give
};

struct UnobservedLight {
    Vec3 position{0};          ///< metres
    glm::dmat3 covariance{0};  ///< of the position, square metres
    Vec3 sigma() const {
        return Vec3(std::sqrt(covariance[0][0]), std::sqrt(covariance[1][1]), std::sqrt(covariance[2][2]));
    }
    float distance = 0;       ///< metres, from the middle of the points it lights
    float distanceSigma = 0;  ///< standard deviation of ln distance
    float fraction = 0;       ///< of the light on the surfaces
};

struct UnobservedLightSearch {
    std::optional<UnobservedLight> light;
    double misfitWithout = 0, misfitWith = 0;  ///< mean robust misfit of the pairs, in variances
    double certainty = 0;                      ///< the gain in standard errors, counted over parts of the scene
    std::string words;                         ///< what was found, or why nothing was
};

/// Is there light that neither the environment nor the emitters known explain, and where does it come from? Looks at
/// ratios of radiance between points of probably equal albedo, as solveAlbedoFree does, so that albedo plays no part. A
/// point emitter is tried at some 1500 places around and in the scene, at each with its power and all other light
/// solved for; the best places are improved by trying others around them, because a shadow's edge moves in jumps, and
/// then by Gauss-Newton on position and light together, shadows traced anew at every step. The covariance is a
/// bootstrap over parts of the scene (boxes of a fifth of its extent), because neighbouring points err alike. Places
/// that a photograph shows to be empty are left out. Light from too far away to have a place joins the environment. The
/// emitter is taken to shine alike in all directions: a panel that faces the scene seems nearer (by a tenth of its
/// distance in a test), which the covariance does not hold. Cost: 5 to 40 s of CPU. Throws Cancelled.
UnobservedLightSearch findUnobservedLight(const Capture& capture, const Scene& scene, const RadianceSamples& samples,
                                          const EmitterClusters& clusters, const UnobservedLightOptions& options,
                                          Progress& progress);

}  // namespace relamp
