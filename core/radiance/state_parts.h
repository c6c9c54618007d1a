// What belongs to one lighting state of a capture: for all that compares photographs with each other.
#pragma once
#include "capture/capture.h"
#include "radiance/samples.h"

namespace relamp {

/// The observations of one state. Views keep their numbers; geometry is left out. The background is
/// that of the state's environment. Cost: O(observations).
RadianceSamples samplesOfState(const RadianceSamples& all, uint32_t state);

/// A capture of the views of one state, numbered anew. Memory: their photographs.
Capture captureOfState(const Capture& capture, uint32_t state);

/// The observations of one state as of such a capture, with its views' geometry. The background likewise.
RadianceSamples samplesOfPart(const RadianceSamples& all, uint32_t state);

/// A view, and those of other lighting states that were taken from its place: what they show of surfaces errs alike.
std::vector<uint32_t> viewsTakenFrom(const Capture& capture, uint32_t view);

}  // namespace relamp
