// What lighting states of one capture must have in common.
#pragma once
#include "capture/capture.h"
#include "radiance/samples.h"

namespace relamp {

/// Between states that share an environment only emitters may change. Warns of two such states whose photographs show
/// another background: its median differs by 15 %, or a third of it by 25 %. States that do not see enough of it in
/// common are taken at their word. Returns the warnings. Cost: one pass over the pixels.
std::vector<std::string> warnOfOtherEnvironments(const Capture& capture, const RadianceSamples& samples);

}  // namespace relamp
