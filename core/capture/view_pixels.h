// What a photograph shows between its pixels.
#pragma once
#include <optional>

#include "capture/capture.h"

namespace relamp {

/// Radiance of a view at a place of it, bilinear; none where one of the four pixels is outside or not usable, or where
/// it is clipped and `clippedToo` is false.
std::optional<Rgb> radianceAt(const View& view, const Vec2& place, bool clippedToo);

}  // namespace relamp
