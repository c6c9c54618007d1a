// Thin parts that a reconstruction has lost and photographs show: handles, posts, ears, edges.
#pragma once
#include "base/progress.h"
#include "capture/capture.h"
#include "radiance/round_sheets.h"
#include "radiance/samples.h"
#include "scene/scene.h"

namespace relamp {

struct MissingParts {
    SurfacePatch surface;
    size_t parts = 0;
};

/// The visual hull of what photographs show and the mesh does not explain: voxels as wide as half a pixel that stand
/// before the mesh in five views or more, of which all but a fifth show something else there than others show of what
/// lies behind, and something alike. Voxels that touch are one part; small ones and such as lie flat on the mesh are
/// left out. `isLight`: per vertex; nothing is said beside lights, nor where a tenth of what views see of the mesh
/// differs from what others do: a hull, gloss. Exact meshes have none; nor has one of which
/// views see parts so far apart that 2e6 cubes of 64 voxels do not hold them. O(views x pixels), voxels by an octree.
/// Throws Cancelled.
MissingParts missingParts(const Scene& scene, const Capture& capture, const RadianceSamples& samples,
                          const std::vector<uint8_t>& isLight, Progress& progress);

}  // namespace relamp
