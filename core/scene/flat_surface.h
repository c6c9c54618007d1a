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

/// What brings a mesh onto its flat surfaces.
struct Flattening {
    std::vector<float> move;    ///< metres along the normal, of each of the first vertices
    std::vector<int> surface;   ///< that the vertex comes to lie on; -1: none, though it may move with its neighbours
    std::vector<double> waves;  ///< metres, of each surface: what its vertices are off by (robust standard deviation)
    std::vector<double> bent;   ///< of each surface: part of the squares of heights that a second order explains
    /// Below 0.6 of it: true planes with waves have 0.01 to 0.32, sides of something round 0.9 and more.
    bool isFlat(size_t of) const;
};

/// Vertices that lie on a surface, and no farther off than thrice its waves, come onto it; what is farther off stands
/// out from it, and sides of something round stay. Those around them follow, each ring of edges by three quarters of
/// the ring before. `vertices`: the first, that may move; none of `leftOut` does. O(vertices).
Flattening flattening(const Scene& scene, const std::vector<FlatSurface>& surfaces, size_t vertices,
                      const std::vector<uint8_t>& leftOut);

}  // namespace relamp
