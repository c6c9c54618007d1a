// A straight body brought to outlines by least squares: thickness and tilt to parts of a pixel. Inner part of the
// clusters, not a door.
#pragma once
#include "clusters/emitter_body.h"

namespace relamp {

/// The body whose silhouettes the outlines' boundaries follow best: Gauss-Newton with Marquardt's damping on distances
/// in the photographs, robust (Cauchy), because an occluder's edge is boundary too. `unit`: metres of a pixel there;
/// half sizes stay above `least` metres. `conical`: a tube may become a cone. O(boundary points x corners x 300).
EmitterBody followOutlines(const Capture& capture, const std::vector<EmitterOutline>& outlines, EmitterBody body,
                           double unit, double least, bool conical = false);

}  // namespace relamp
