// Which cameras cannot have taken a photograph: one rule for every file that cameras come from.
#pragma once
#include <string>

#include "capture/camera.h"

namespace relamp {

/// How a file calls what a camera holds.
struct IntrinsicNames {
    const char *focalX, *focalY, *centreX, *centreY;
};

/// What is wrong, by those names ("fl_x is 1e-310, expected 0.001 to 1e+09 pixels"); empty for a good camera. With a
/// focal length below a thousandth of a pixel, or a principal point a thousand images away, nothing is seen.
std::string faultOf(const Camera& camera, const IntrinsicNames& names);

}  // namespace relamp
