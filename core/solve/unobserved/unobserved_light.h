// Emitters that no photograph shows and no mesh holds, found by what they do: shading that falls off with distance, and
// shadows.
#pragma once
#include <optional>
#include <string>

#include "base/progress.h"
#include "capture/capture.h"
#include "clusters/emitter_clusters.h"
#include "radiance/samples.h"
#include "scene/scene.h"
#include "solve/unobserved/suspected_light.h"

namespace relamp {

struct UnobservedLightOptions {
    uint64_t seed = 1;
    size_t pairs = 5000;          ///< of points of probably equal albedo, looked at while places are compared
    size_t finalPairs = 20000;    ///< and for the answer
    float leastGain = 0.05f;      ///< fraction of the misfit that emitters must explain to be taken for real
    float leastOwnGain = 0.05f;   ///< and each of several beside the others
    float leastFraction = 0.05f;  ///< of the light on the surfaces that each must give
    size_t most = 6;              ///< emitters
    int directionSide = 14;       ///< places are tried in its square of directions
    size_t followed = 6;          ///< of the best places
    bool suspicion = false;       ///< the first look alone (suspectUnobservedLight)
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
    EmissionLobe lobe{};      ///< where it shines to one side
    float radius = 0;         ///< metres, of one whose shadows are soft; 0: not told from a point
    double certainty = 0;  ///< what it explains beside the others, in standard errors counted over parts of the scene
};

struct UnobservedLightSearch {
    std::vector<UnobservedLight> lights;
    double misfitWithout = 0, misfitWith = 0;  ///< mean robust misfit of the pairs, in variances
    double certainty = 0;                      ///< of the surest one
    std::string words;                         ///< what was found, or why nothing was
};

/// Is there light that neither the environment nor the emitters known explain, and where does it come from? Looks at
/// ratios of radiance between points of probably equal albedo, as solveAlbedoFree does, so that albedo plays no part. A
/// point emitter is tried at some 1500 places around and in the scene, at each with its power and all other light
/// solved for; the best places are improved by trying others around them, because a shadow's edge moves in jumps, and
/// then by Gauss-Newton on position and light together, shadows traced anew at every step. Then it is tried as one
/// whose radiance is a power of the cosine to an axis, and larger. Further emitters are looked for with those found
/// among what is known, while they explain more; then each moves to where it is best beside the others, and those that
/// the others explain as well are dropped. The covariance is a bootstrap over parts of the scene (boxes of a fifth of
/// its extent), because neighbouring points err alike. Places that a photograph shows to be empty are left out. Light
/// from too far away to have a place joins the environment. Cost: 10 s to 3 min of CPU an emitter. Throws Cancelled.
UnobservedLightSearch findUnobservedLights(const Capture& capture, const Scene& scene, const RadianceSamples& samples,
                                           const EmitterClusters& clusters, const UnobservedLightOptions& options,
                                           Progress& progress);

/// Is the search worth while? Its first look, with 800 places and 1500 pairs, for one small light that shines alike in
/// all directions; none where it explains less than 5 % of the misfit, or by less than 4 standard errors, or gives less
/// than 5 % of the light, or where one far away in its direction does not explain less by 4 standard errors. Cost: 1 to
/// 10 s of CPU. Throws Cancelled.
std::optional<SuspectedLight> suspectUnobservedLight(const Capture& capture, const Scene& scene,
                                                     const RadianceSamples& samples, const EmitterClusters& clusters,
                                                     uint64_t seed, Progress& progress);

/// What was found in several lighting states, each light once: as the state knows it that is surest of it.
UnobservedLightSearch joinedSearches(const std::vector<std::string>& states,
                                     const std::vector<UnobservedLightSearch>& searches);

}  // namespace relamp
