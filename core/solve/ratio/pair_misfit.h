// How badly given light explains the ratios of pairs: what decides whether a part of the model belongs to it.
#pragma once
#include <vector>

#include "solve/gloss/matte.h"
#include "solve/ratio/pairs.h"

namespace relamp {

/// Misfit of one pair in variances, bent (Cauchy, 2.5), times its weight: noise and a model error of 1.5 % a point.
/// `lit` and `again`: irradiances of the observations that differ by the noise of their rays alone. The product of both
/// residuals is free of that noise on the mean, which else would speak against whatever is computed from rays.
double pairMisfit(const MatteObservations& matte, const AlbedoPair& pair, const std::vector<Rgb>& lit,
                  const std::vector<Rgb>& again);

/// The sum over all pairs. The same bits on any number of threads.
double pairMisfit(const MatteObservations& matte, const std::vector<AlbedoPair>& pairs, const std::vector<Rgb>& lit,
                  const std::vector<Rgb>& again);

}  // namespace relamp
