// What may stand in the way of light: the ground, which never moves, and parts that do. A part keeps its own small ray
// tracer in its own frame and rays are carried into it, so that nothing is rebuilt while it is dragged.
#pragma once
#include <memory>
#include <span>

#include "relight/relit_scene.h"

namespace relamp {

/// Triangles that move as one.
struct LivePart {
    int emitter = -1;  ///< index into the emitters; -1: a part
    Mat4 matrix{1};    ///< world from part
    Mat4 inverse{1};
    std::shared_ptr<const RayTracer> tracer;  ///< in the part's frame
    std::vector<Vec3> faceNormals;            ///< of its triangles, in the part's frame
    Vec3 centre{0};                           ///< of a sphere in the world that holds it
    float radius = 0;
    std::string key;  ///< the same for the same geometry: its tracer can be kept

    /// Whether the sphere, seen from `point`, can cover any direction within `angle` of `axis` nearer than `far`.
    bool mayCover(const Vec3& point, const Vec3& axis, float angle, float far) const;
    /// Direction and half angle of the sphere from `point`; a point inside sees it everywhere.
    void cone(const Vec3& point, Vec3& axis, float& angle) const;
    /// Bit i is set where ray i hits the part.
    uint32_t occluded8(std::span<const Ray> rays) const;
    /// Distance in metres of the world; `facing`: the front of a triangle was hit.
    Hit closest(const Ray& ray, bool& facing) const;
};

/// Parts of an edited geometry, tracers taken from `previous` where the key is the same. Entry 0 (the ground) is left
/// empty.
std::vector<LivePart> liveParts(const EditedGeometry& geometry, const Look& look,
                                const std::vector<LivePart>& previous);

/// The triangles of one part of a mesh with only their vertices, carried by `matrix`; no normals.
Mesh partMesh(const Mesh& mesh, const std::vector<uint32_t>& partOfTriangle, uint32_t part, const Mat4& matrix);

/// A tracer over the triangles of one part of a geometry as they stand; empty when it has none.
std::shared_ptr<const RayTracer> tracerOf(const EditedGeometry& geometry, uint32_t part);

/// Everything that blocks.
struct LiveOccluders {
    std::shared_ptr<const RayTracer> ground;  ///< empty: nothing stays in place
    std::vector<LivePart> parts;              ///< entry 0 unused
    float offset = 0;                         ///< metres: how far rays start off a surface

    Vec3 origin(const Vec3& position, const Vec3& normal) const { return position + normal * (4 * offset); }
    uint32_t groundOccluded8(std::span<const Ray> rays) const { return ground ? ground->occluded8(rays) : 0u; }
    /// Ground and all parts, up to 8 rays.
    uint32_t occluded8(std::span<const Ray> rays) const;
    bool occluded(const Ray& ray) const { return occluded8({&ray, 1}) != 0; }
};

}  // namespace relamp
