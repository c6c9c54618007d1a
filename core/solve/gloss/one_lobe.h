// Light and the strength of one lobe together, for scenes where nothing is matte: y = w (D L + N P) is linear in z = w
// x and w.
#pragma once
#include "solve/gloss/gloss.h"
#include "solve/priors/anchors.h"

namespace relamp {

struct OneLobeFit {
    Lighting lighting;
    Rgb weight{1};
    double residual = 0;  ///< robust mean squared residual, in standard deviations
    double kktResidual = 0;
};

/// Unknowns per channel: z = w x >= 0 (leaves, emitters) and w >= 0. Rows: the observations G z = y, and what is seen
/// directly, z_i = w a_i for background leaves and emitters, so the split of w and x is part of the same program
/// instead of a slow alternation. `guess` saves pivots. Cost: three reweighted quadratic programs a channel.
OneLobeFit fitOneLobe(const InfluenceMatrix& rows, const std::vector<GlossyObservation>& observations,
                      const LightAnchors& anchors, const Lighting& guess, Progress& progress);

}  // namespace relamp
