// How much the look of a vertex changes with the view.
#pragma once
#include "radiance/samples.h"

namespace relamp {

/// Relative standard deviation of a vertex's luminance between its views, noise taken out. -1 where nothing is known:
/// fewer than two good observations, or hardly brighter than noise. Under one lighting state.
float viewSpread(const RadianceSamples& samples, uint32_t vertex);

}  // namespace relamp
