// Emitters that are one surface with what they stand on, as in a reconstruction: who moves one needs its underside and
// the place it stood on.
#pragma once
#include <vector>

#include "clusters/emitter_clusters.h"
#include "scene/scene.h"

namespace relamp {

/// The mesh with what closes it once emitters leave. Vertices and triangles of the capture keep their numbers.
struct ClosedMesh {
    Mesh mesh;
    std::vector<uint32_t> vertexOrigin;     ///< per vertex the capture's whose reflectance it has
    std::vector<EmitterCluster> emitters;   ///< with the triangles of their undersides
    std::vector<int> emitterOfNewTriangle;  ///< per triangle behind the capture's: -1 for those of the ground
    std::vector<uint32_t> untextured;  ///< the capture's triangles about the emitters' places, whose texels they hid
    std::vector<uint8_t> left;         ///< per emitter 1: it leaves
};

/// Closes the border between each piece of an emitter and the surface that goes on there (80 % of the border's edges):
/// a fan of triangles for the surface, with the reflectance of vertices three edges outside, and another that shines,
/// where the emitter stands out (twice the area of the fans): a body that glows evenly glows below as well. The
/// radiance is the emitter's. `leaves`: per emitter, 0 leaves it as it is. Closed emitters and open sheets are left
/// alone. O(triangles) for each emitter that leaves, beside a copy of the mesh.
ClosedMesh closeStandingEmitters(const Scene& scene, const std::vector<EmitterCluster>& emitters,
                                 const std::vector<uint8_t>& leaves);

}  // namespace relamp
