// Rays against the scene. Embree (3 or 4) is named only in ray_tracer.cpp.
#pragma once
#include <memory>
#include <span>

#include "scene/mesh.h"

namespace relamp {

struct Ray {
    Vec3 origin;
    Vec3 direction;               ///< unit
    float near = 0, far = 1e30f;  ///< metres along the direction
};

struct Hit {
    static constexpr uint32_t none = ~0u;
    uint32_t triangle = none;  ///< index into the mesh's triangles; none: nothing was hit
    float distance = 0;        ///< metres
    Vec2 barycentric{0};       ///< weights of corners 1 and 2; corner 0 has the rest
    explicit operator bool() const { return triangle != none; }
};

/// An acceleration structure over one mesh (robust mode: no leaks between neighbouring triangles). Queries are
/// thread-safe; 13-18 million coherent rays a second a core.
class RayTracer {
public:
    /// `diagonal`: the mesh's extent, metres, that surfaceOffset() is a fraction of; 0: of its box along the world's
    /// axes. For light, mesh.shadowless is not there.
    enum class For { light, cameras };
    explicit RayTracer(const Mesh& mesh, float diagonal = 0, For rays = For::light);
    ~RayTracer();
    RayTracer(RayTracer&&) noexcept;
    RayTracer& operator=(RayTracer&&) noexcept;

    Hit closest(const Ray& ray) const;
    bool occluded(const Ray& ray) const;
    /// occluded() for up to 8 rays at once; bit i is set where ray i hits something.
    uint32_t occluded8(std::span<const Ray> rays) const;
    /// closest() for up to 8 rays at once.
    void closest8(std::span<const Ray> rays, std::span<Hit> hits) const;

    /// Distance to step off a surface before tracing on, metres: 1e-4 of the scene's diagonal at most, set by the
    /// precision of its coordinates.
    float surfaceOffset() const { return surfaceOffset_; }

private:
    struct Embree;
    std::unique_ptr<Embree> embree_;
    float surfaceOffset_ = 0;
};

}  // namespace relamp
