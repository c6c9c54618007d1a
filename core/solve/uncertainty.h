// How sure the light is: the curvature of the objective at the answer, turned into standard deviations and into words.
#pragma once
#include <string>
#include <vector>

#include "solve/ratio/albedo_free.h"

namespace relamp {

struct UncertaintyOptions {
    /// Neighbouring observations err alike and an observation stands in a dozen pairs, while the objective takes pairs
    /// for independent: standard deviations are widened by this factor. Measured on captures with truth, see
    /// tests/bench/README.md.
    float widening = 4.0f;
    float scaleFloor = 0.05f;  ///< what models of light and surfaces are off by in brightness however much is measured;
                               ///< measured likewise
    int directions = 48;       ///< the most uncertain ones that a row's deviation is summed over
    bool bounced = false;      ///< bounced light of known radiance is in the model
    bool backdrop =
        false;  ///< the background seen is not what lights the scene (tiesScale): it says nothing of the scale
    /// Of LightInformation::all, per channel, the part of light probes, and that of surfaces of known albedo, which
    /// LightInformation::observations holds too; empty without any.
    std::array<Eigen::MatrixXd, 3> probes = {}, patches = {};
    bool scaleOnly = false;  ///< leave out everything but the scale and what fixes it
};

/// Standard deviations are relative to the value unless said otherwise. Channels are apart.
struct LightUncertainty {
    std::vector<Rgb> leafSigma;     ///< radiance
    std::vector<Rgb> emitterSigma;  ///< radiance
    std::vector<Rgb> litSigma;      ///< per row: of the light on it, and so of its albedo; relative
    Rgb scaleSigma{0};              ///< of the brightness of all light against all albedo, relative; at most 10
    /// Fractions of the evidence that fixes this scale, each in [0, 1], together 1 (or 0 where there is none).
    Rgb fromEmitters{0}, fromBackground{0}, fromGloss{0}, fromBounces{0}, fromProbes{0}, fromPatches{0};
    std::string weakest;     ///< the direction of light that the photographs tell least about, in words
    float weakestSigma = 0;  ///< what it may add to or take from the light on the surfaces, root mean square, relative
};

/// `b`: rows of the light's influence on the observations, `lit` the light on them. Unknowns at their bound count as
/// known. Memory: some n x n doubles; cost: a factorisation of 2n unknowns and an eigenvalue problem of n for each
/// channel, one pass over `b`.
LightUncertainty lightUncertainty(const LightInformation& information, const InfluenceMatrix& b,
                                  const std::vector<Rgb>& lit, const Lighting& lighting,
                                  const std::vector<std::string>& emitterNames, const UncertaintyOptions& options,
                                  Progress& progress);

}  // namespace relamp
