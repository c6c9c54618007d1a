// How much the look of a vertex changes with the view.
#pragma once
#include "radiance/samples.h"

namespace relamp {

/// Relative standard deviation of a vertex's luminance between the views of one lighting state, noise taken out. -1
/// where nothing is known: fewer than two good observations, or hardly brighter than noise.
float viewSpread(const RadianceSamples& samples, uint32_t vertex, uint32_t state = 0);

}  // namespace relamp
