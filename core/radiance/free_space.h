// Mesh that stands where photographs see past it: skirts, with which a reconstruction goes on beyond what was
// photographed.
#pragma once
#include <vector>

#include "base/progress.h"
#include "capture/capture.h"
#include "radiance/samples.h"
#include "scene/scene.h"

namespace relamp {

/// Triangles in free space, ascending. A surface has one radiance at a place; the background has one in a direction. A
/// vertex is of a skirt where the photographs differ as the background does in their directions of view and not as one
/// place may; its region is what the background explains around it. Triangles go where more pixels show the background
/// through them than a surface. `isLight`: per vertex, non-zero for those of emitters. Exact meshes have none. The
/// background must be seen elsewhere in its directions, and views must agree on it, all or all but one of five or more.
/// O(pixels); where one is left out, O(observations) for each that may be. Throws Cancelled.
std::vector<uint32_t> freeSpaceTriangles(const Scene& scene, const Capture& capture, const RadianceSamples& samples,
                                         const std::vector<uint8_t>& isLight, Progress& progress);

}  // namespace relamp
