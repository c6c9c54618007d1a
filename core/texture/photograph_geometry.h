// What each pixel of a photograph sees, and how far from the edge of what it sees it lies.
#pragma once
#include "base/progress.h"
#include "capture/capture.h"
#include "scene/scene.h"

namespace relamp {

struct PhotographGeometry {
    int width = 0, height = 0;
    std::vector<uint8_t> away;       ///< pixels to the nearest edge, 0 to 3; 0 where unusable or clipped too
    size_t surfacePixels = 0;        ///< that are not 0
    std::vector<uint32_t> triangle;  ///< per pixel the one at its centre, where asked for

    /// Trust in a pixel, in [0, 1].
    float weight(int x, int y) const {
        constexpr std::array<float, 4> trust{0.0f, 0.05f, 0.4f, 1.0f};
        return trust[away[size_t(y) * size_t(width) + size_t(x)]];
    }
};

/// Of one view, without triangles. Cost, errors: as photographGeometry.
PhotographGeometry geometryOfView(const View& view, const Scene& scene, const std::vector<int>& emitterOfTriangle,
                                  Progress& progress);

/// One a view. Edges are where depth jumps, where the surface ends, and where an emitter begins. `density` becomes, per
/// vertex, pixels a metre in the view that sees it finest, 0 where none does; of large photographs some pixels tell it.
/// Cost: one ray a pixel. Memory: 1 B a pixel, 5 B with `keepTriangles`, 20 B while a view is looked at.
std::vector<PhotographGeometry> photographGeometry(const Capture& capture, const Scene& scene,
                                                   const std::vector<int>& emitterOfTriangle, bool keepTriangles,
                                                   std::vector<float>& density, Progress& progress);

}  // namespace relamp
