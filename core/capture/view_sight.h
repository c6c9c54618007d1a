// What one photograph sees of a mesh, by projection and a small depth image. Inner part of the check, not a door.
#pragma once
#include <vector>

#include "base/progress.h"
#include "capture/check.h"

namespace relamp {

/// What one view says of the mesh: which vertices it sees, and how bright some of them are.
struct ViewSight {
    std::vector<uint8_t> sees;      ///< per vertex
    std::vector<float> brightness;  ///< log2 luminance per sampled vertex; NaN where it is not seen
    uint32_t state = 0;             ///< lighting state of the view
};

/// `camera`: of the view, or where else it might stand. `referenced`: per vertex, 1 where a triangle names it; every
/// `stride`th one's brightness is read. Fills what `check` holds of the mesh in the view. Cost: O(vertices +
/// triangles). Throws Cancelled.
ViewSight lookAt(const View& view, const Camera& camera, const Mesh& mesh, const std::vector<uint8_t>& referenced,
                 size_t stride, ViewCheck& check, const Progress& progress);

/// Median over the surface of how much views disagree on its brightness, stops; infinite where fewer than
/// enoughVertices are seen twice.
float disagreement(const std::vector<ViewSight>& sights);

}  // namespace relamp
