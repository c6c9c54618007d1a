// What lighting states of one capture must have in common.
#pragma once
#include "capture/capture.h"
#include "radiance/samples.h"

namespace relamp {

/// Between the states only emitters may change. Throws Error naming two states whose photographs show another
/// background: its median differs by 15 %, or a third of it by 25 %. States that do not see enough of it in common are
/// taken at their word. Cost: one pass over the pixels.
void refuseOtherEnvironments(const Capture& capture, const RadianceSamples& samples);

}  // namespace relamp
