// How far the pixels of a photograph are from edges of what they show.
#pragma once
#include <vector>

#include "capture/capture.h"
#include "radiance/samples.h"
#include "scene/scene.h"

namespace relamp {

/// Pixels to the nearest one that shows no surface or beside which another surface begins (chessboard distance, at most
/// 255; 0 at such a pixel and outside the photograph's rim). O(pixels).
std::vector<uint8_t> edgeDistance(const View& view, const ViewGeometry& geometry, const Scene& scene);

}  // namespace relamp
