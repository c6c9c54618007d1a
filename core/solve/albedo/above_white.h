// Vertices that show more light than any surface reflects: a mesh that is off shows an emitter on what lies beside it.
#pragma once
#include "solve/gloss/matte.h"
#include "solve/state/irradiance.h"

namespace relamp {

/// What surfaces send that reflect at most a white of `most`, the larger of 0.95 and 1.2 times the 90th percentile of
/// the albedo that observations need: shown radiance, `most * irradiance` at most, per observation and channel. Metals
/// send what they show. `component`: of the vertices. O(n log n).
std::vector<Rgb> reflectedAtMost(const MatteObservations& matte, const std::vector<Rgb>& irradiance,
                                 const std::vector<uint32_t>& component);

/// Irradiance of observations that show a fifth more than that, in any channel, becomes unknown: they say nothing of
/// albedo. O(n log n).
Irradiance unsureAboveWhite(const MatteObservations& matte, Irradiance irradiance);

}  // namespace relamp
