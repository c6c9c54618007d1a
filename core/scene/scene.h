// Room 2's product: the mesh with what every later room asks of it (rays, neighbours, sizes).
#pragma once
#include <memory>

#include "base/progress.h"
#include "scene/mesh.h"
#include "scene/ray_tracer.h"

namespace relamp {

struct Scene {
    Mesh mesh;
    VertexGraph graph;                ///< vertices joined by an edge
    std::vector<uint32_t> component;  ///< connected component of each vertex
    uint32_t components = 0;
    std::vector<uint32_t> material;   ///< of each vertex: its component's, but for parts that shine (findMaterials)
    uint32_t materials = 0;           ///< those of the components first
    std::vector<uint8_t> shines;      ///< per material: 1 where photographs show that it has a lobe (findMaterials)
    Mat3 axes{1};  ///< world from axes that turn with the scene: what squares of directions and random patterns of a
                   ///< solve lie along, so that its answer does not rest on how the world lies
    std::vector<uint32_t>
        rank;  ///< a number drawn from where each vertex lies and which way it faces: what random patterns are numbered
               ///< by, so that they rest neither on the file's order nor on its unit, origin or axes
    std::vector<float> vertexSpacing;               ///< metres: mean edge length at the vertex
    std::vector<uint8_t> referenced;                ///< 1 where a triangle uses the vertex
    float diagonal = 0;                             ///< metres: of the bounding box
    std::shared_ptr<const RayTracer> tracer;        ///< for light
    std::shared_ptr<const RayTracer> cameraTracer;  ///< for what cameras see; the same unless mesh.shadowless holds any

    /// Point and shading normal of a hit.
    Vec3 pointOf(const Hit& hit) const;
    Vec3 normalOf(const Hit& hit) const;
};

/// Mesh -> Scene. `axes`: see Scene. Cost O(n log n). Throws std::invalid_argument where the mesh has not one normal
/// for each vertex, Error when the ray tracer cannot be built.
Scene buildScene(Mesh mesh, Progress& progress, const Mat3& axes = Mat3(1));

}  // namespace relamp
