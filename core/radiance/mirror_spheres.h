// Balls that mirror their environment: chrome balls, brass knobs. A reconstruction leaves waves on them, and a normal
// that is a degree off mirrors another part of the sky.
#pragma once
#include "capture/mesh_mend.h"
#include "radiance/samples.h"
#include "scene/scene.h"

namespace relamp {

struct MirrorSphere {
    DVec3 centre{0};  ///< metres
    double radius = 0;
    float off = 0;                   ///< metres: how far the mesh lies from it, robust standard deviation
    std::vector<uint32_t> vertices;  ///< that lie on it and face outwards, ascending
};

/// Spheres in what changes with the view by a fifth and more: drawn by two vertices with normals [Schnabel07], refined
/// by robust least squares on distances. Kept where a third of the sphere is there, half of its vertices change so and
/// twice as much as the others of the scene, and the mesh lies within 0.15 % of the scene's diagonal (robust standard
/// deviation). `leftOut`, per vertex (non-zero: lights): not asked. The same answer in any order of the vertices.
/// O(components x trials x 2000 vertices).
std::vector<MirrorSphere> mirrorSpheres(const Scene& scene, const RadianceSamples& samples,
                                        const std::vector<uint8_t>& leftOut);

/// Per vertex of `count` 1 where a sphere lies.
std::vector<uint8_t> verticesOfSpheres(const std::vector<MirrorSphere>& spheres, size_t count);

/// What brings the mesh onto a sphere: places and normals of its vertices. Nothing where half of the normals are right
/// to 0.2 degrees.
struct RoundedSphere {
    std::vector<MeshMend::MovedVertex> moved;
    std::vector<MeshMend::TurnedVertex> turned;
};
RoundedSphere roundedSphere(const MirrorSphere& sphere, const Mesh& mesh);

}  // namespace relamp
