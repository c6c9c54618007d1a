// Light given the reflectance: the joint quadratic program for environment and emitter radiances (equations 4 to 6).
#pragma once
#include "base/progress.h"
#include "solve/priors/light_prior.h"
#include "solve/ratio/albedo_free.h"

namespace relamp {

struct LightingStepReport {
    double before = 0, after = 0;  ///< robust objective with the priors on the light
    double rmse = 0;               ///< of the model after the step, radiance
    double kktResidual = 0;
};

/// min over x >= 0 of sum w_i (y_i - albedo_i (B_i x + bounce_i))^2 + priors, all channels, with Cauchy weights at the
/// start's residuals. The step is halved until the objective does not rise; if it never falls, `lighting` stays as it
/// was. `litSigma[i]`: standard deviation of B_i x. `bounce`: light from other surfaces per observation, or empty.
LightingStepReport lightingStep(const InfluenceMatrix& influence, const MatteObservations& matte,
                                const std::vector<Rgb>& albedo, const std::vector<Rgb>& litSigma,
                                const LightPrior& prior, const std::vector<Rgb>& bounce, Lighting& lighting,
                                Progress& progress);

}  // namespace relamp
