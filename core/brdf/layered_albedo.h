// The colour of a surface under its coating. The solver's model adds a coating's lobe and a matte part; but what a
// coating turns away does not reach the surface under it.
#pragma once
#include "brdf/basis.h"

namespace relamp {

/// Fraction of even light from all sides that a lobe of weight 1 sends back: the mean of its directional albedo over
/// cosine-distributed eyes. A sum over 16 eye angles and 4096 directions, within 1 %.
float hemisphericalAlbedo(const Lobe& lobe);

/// Diffuse albedo per vertex: weight 0 over the fraction of light that gets through to it, 1 - sum of weight_k x
/// hemisphericalAlbedo(k), at least 0.3 (albedo scaling, as layered materials of production renderers have it
/// [Georgiev19]). At most 1. `weight[k][vertex]`: all lobes of `basis`, Lambert first.
std::vector<Rgb> albedoUnderCoating(const BrdfBasis& basis, const std::vector<std::vector<Rgb>>& weight);

}  // namespace relamp
