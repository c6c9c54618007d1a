// The large flat surfaces of a mesh: floors, walls, tops of tables.
#pragma once
#include "scene/scene.h"

namespace relamp {

struct FlatSurface {
    DVec3 point{0};     ///< metres, on it
    DVec3 up{0, 0, 1};  ///< unit: its normal, to the side that the mesh faces
    double area = 0;    ///< m2 of the mesh on it
    double off(const DVec3& p) const { return glm::dot(p - point, up); }
};

/// Whether a vertex lies on it: 0.4 % of the diagonal off at most, and turned by at most 25 degrees.
bool liesOn(const Scene& scene, const FlatSurface& surface, uint32_t vertex);

/// Planes that hold a twentieth of the mesh's area, the largest four, largest first (RANSAC, then least squares).
/// Vertices of `leftOut` (non-zero: lights) are of none. O(trials x vertices).
std::vector<FlatSurface> flatSurfaces(const Scene& scene, const std::vector<uint8_t>& leftOut);

}  // namespace relamp
