// Axes that turn with a capture: what is laid along them does not rest on how its files name the world's axes.
#pragma once
#include "capture/capture.h"

namespace relamp {

/// World from axes of the capture's own, a rotation: Z is where the cameras' upper sides point on average, X where the
/// first photograph by name looks, made level. The identity without cameras. Turning the capture turns them alike;
/// units, origin and the views' order do not matter.
Mat3 ownAxes(const Capture& capture);

}  // namespace relamp
