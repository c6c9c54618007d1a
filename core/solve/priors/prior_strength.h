// How strong the priors are: the data choose, by what they predict of data that were left out, or the artist does.
#pragma once
#include <string>
#include <vector>

#include "solve/albedo/albedo_step.h"
#include "solve/estimate.h"
#include "solve/ratio/albedo_free.h"

namespace relamp {

/// What the data are asked about, as factors on the usual strength of a prior.
inline const std::vector<float>& strengthsTried() {
    static const std::vector<float> factors{0.25f, 1, 4};
    return factors;
}

/// The factor that predicts what was left out best, unless the usual one is within three standard errors of it (after
/// [Breiman84]). `misfits[k][block]`: of the k-th factor of strengthsTried() on each block of data that was left out;
/// blocks err independently. Fewer than two blocks: the usual one.
PriorStrength chooseStrength(const std::vector<std::vector<double>>& misfits);

/// Smoothness of the light: fits it to pairs in some blocks of space, and holds it against pairs in others. Blocks of
/// space, because texture is alike in neighbouring pairs. Takes at most `maxRows` observations; cost: two iterations of
/// solveAlbedoFree on half of them for each factor. `lighting`: the light found with the usual strength, from which
/// each fit starts; `positions`: of the observations, metres.
PriorStrength testLightStrength(const InfluenceMatrix& influence, const MatteObservations& matte,
                                const std::vector<AlbedoPair>& pairs, const std::vector<Vec3>& positions,
                                const LightAnchors& anchors, const AlbedoFreeOptions& options, const Lighting& lighting,
                                size_t maxRows, Progress& progress);

/// Smoothness of the surfaces: every observation is predicted from the vertex's other observations and its neighbours
/// (leave one view out). In closed form for the albedo found: the residual with the observation is the one without it,
/// times one less the weight of the observation in its own vertex [Wahba90]; weights by random probes of the inverse
/// [Hutchinson89]. One channel, green. Cost: a sparse factor and a few solves for each factor.
PriorStrength testAlbedoStrength(const Scene& scene, const RadianceSamples& samples, const MatteObservations& matte,
                                 const std::vector<Rgb>& lit, const std::vector<Rgb>& litSigma,
                                 const AlbedoPrior& prior, const std::vector<Rgb>& albedo, uint64_t seed,
                                 Progress& progress);

}  // namespace relamp
