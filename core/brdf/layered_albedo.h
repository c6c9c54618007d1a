// The colour of a surface under its coating. The solver's model adds a coating's lobe and a matte part; but what a
// coating turns away does not reach the surface under it.
#pragma once
#include "brdf/basis.h"

namespace relamp {

/// Fraction of even light from all sides that a lobe of weight 1 sends back: the mean of its directional albedo over
/// cosine-distributed eyes. Drawn from the lobe and the cosine [Veach97], 512 directions for each of 16 eyes: within
/// 1 %.
float hemisphericalAlbedo(const Lobe& lobe);
/// Of every lobe of a basis; Lambert's is 1.
std::vector<float> hemisphericalAlbedos(const BrdfBasis& basis);

/// Diffuse albedo per vertex: weight 0 over the fraction of light that gets through to it, 1 - sum of weight_k x
/// hemisphericalAlbedo(k), at least 0.3 (albedo scaling, as layered materials of production renderers have it
/// [Georgiev19]). At most 1. `weight[k][vertex]`: all lobes of `basis`, Lambert first.
std::vector<Rgb> albedoUnderCoating(const BrdfBasis& basis, const std::vector<std::vector<Rgb>>& weight);

}  // namespace relamp
