// Where a photograph shows an outline of the surface, beside where the mesh has it.
#pragma once
#include <vector>

#include "base/progress.h"
#include "capture/capture.h"
#include "scene/scene.h"

namespace relamp {

/// The middle of an edge of the mesh that is an outline in one view: one of its triangles faces the camera, the other
/// does not, and behind it lies nothing or another surface.
struct ContourPoint {
    uint32_t view = 0;
    std::array<uint32_t, 2> vertex{};  ///< of the edge
    Vec2 outward{0};                   ///< unit, in the photograph: away from the surface
    float offset = 0;                  ///< pixels along `outward` from the mesh's outline to the photograph's
};

/// Outlines that photographs show clearly: along the normal of the outline, within four pixels, one step between two
/// smooth sides explains radiance far better than no step, and better than a step elsewhere (solve/registration/
/// step_edge.h). `cameras`: of the views, as they are now; `tracer`: of the mesh. `floor`: radiance that counts as
/// dark. Some 30 microseconds a point.
/// Throws Cancelled.
std::vector<ContourPoint> findContours(const std::vector<View>& views, const std::vector<Camera>& cameras,
                                       const Mesh& mesh, const RayTracer& tracer, float floor,
                                       const Progress& progress);

}  // namespace relamp
