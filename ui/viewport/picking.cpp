#include "viewport/picking.h"

#include "base/parallel.h"

namespace relamp::ui {
namespace {

struct Nearest {
    float distance = 1e30f;
    uint32_t triangle = Hit::none;
    Vec2 barycentric{0};
};

/// Moller and Trumbore 1997, both sides.
bool intersect(const Ray& ray, const Vec3& a, const Vec3& b, const Vec3& c, float& distance, Vec2& barycentric) {
    const Vec3 ab = b - a, ac = c - a, p = glm::cross(ray.direction, ac);
    const float determinant = glm::dot(ab, p);
    if (std::abs(determinant) < 1e-20f) return false;
    const float inverse = 1 / determinant;
    const Vec3 s = ray.origin - a;
    const float u = glm::dot(s, p) * inverse;
    if (u < 0 || u > 1) return false;
    const Vec3 q = glm::cross(s, ab);
    const float v = glm::dot(ray.direction, q) * inverse;
    if (v < 0 || u + v > 1) return false;
    distance = glm::dot(ac, q) * inverse;
    barycentric = {u, v};
    return distance > ray.near && distance < ray.far;
}

}  // namespace

std::optional<PickedPoint> pickSurface(const Mesh& mesh, const Ray& ray, std::span<const uint8_t> visible) {
    constexpr size_t block = 1 << 14;
    std::vector<Nearest> nearest((mesh.triangles.size() + block - 1) / block);
    parallelBlocks(mesh.triangles.size(), block, [&](size_t begin, size_t end) {
        Nearest best;
        for (size_t t = begin; t < end; ++t) {
            if (!visible.empty() && !visible[t]) continue;
            const Triangle& i = mesh.triangles[t];
            float distance;
            Vec2 barycentric;
            if (intersect(ray, mesh.positions[i[0]], mesh.positions[i[1]], mesh.positions[i[2]], distance,
                          barycentric) &&
                distance < best.distance)
                best = {distance, uint32_t(t), barycentric};
        }
        nearest[begin / block] = best;
    });
    Nearest best;
    for (const Nearest& n : nearest)
        if (n.distance < best.distance) best = n;
    if (best.triangle == Hit::none) return std::nullopt;

    PickedPoint point;
    const Triangle& corners = mesh.triangles[best.triangle];
    const Vec3 weights(1 - best.barycentric.x - best.barycentric.y, best.barycentric.x, best.barycentric.y);
    point.triangle = best.triangle;
    point.barycentric = best.barycentric;
    point.position = ray.origin + best.distance * ray.direction;
    Vec3 normal(0);
    int most = 0;
    for (int k = 0; k < 3; ++k) {
        normal += weights[k] * mesh.normals[corners[size_t(k)]];
        if (weights[k] > weights[most]) most = k;
    }
    const float length = glm::length(normal);
    point.normal = length > 1e-6f ? normal / length : mesh.faceNormal(best.triangle);
    point.vertex = corners[size_t(most)];
    return point;
}

Rgb radianceAt(const LiveFrame& frame, const PickedPoint& point) {
    const auto& corners = frame.mesh->triangles[point.triangle];
    const Vec2 b = point.barycentric;
    return (1 - b.x - b.y) * frame.radiance[corners[0]] + b.x * frame.radiance[corners[1]] +
           b.y * frame.radiance[corners[2]];
}

std::optional<Rgb> radianceAlong(const LiveFrame& frame, const Ray& ray, std::span<const uint8_t> visible) {
    const std::optional<PickedPoint> point = pickSurface(*frame.mesh, ray, visible);
    if (!point) return std::nullopt;
    return radianceAt(frame, *point);
}

std::vector<uint8_t> visibleTriangles(const Mesh& mesh, const std::vector<uint32_t>* origin, const Scene& scene,
                                      const std::set<uint32_t>& hiddenComponents) {
    if (hiddenComponents.empty()) return {};
    std::vector<uint8_t> visible(mesh.triangles.size(), 1);
    for (size_t t = 0; t < visible.size(); ++t) {
        uint32_t v = mesh.triangles[t][0];
        if (origin) v = v < origin->size() ? (*origin)[v] : Hit::none;
        if (v < scene.component.size() && hiddenComponents.contains(scene.component[v])) visible[t] = 0;
    }
    return visible;
}

}  // namespace relamp::ui
