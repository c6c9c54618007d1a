#include "radiance/back_sides.h"

#include <algorithm>

#include "base/parallel.h"
#include "base/random.h"

namespace relamp {
namespace {

constexpr float thickness = 0.001f;      ///< of the diagonal
constexpr float leastBackCosine = 0.1f;  ///< between a back and the view that sees it
constexpr uint8_t leastBackViews = 2;
constexpr uint32_t raysFromLight = 1 << 14;
constexpr float reachOfLight = 10;  ///< of the ball's radius: a shade is about it

/// The first hit but those of triangles marked `clear`.
Hit hitPast(const Scene& scene, const std::vector<uint8_t>& clear, Ray ray) {
    Hit hit;
    for (int layers = 0; layers < 16; ++layers) {
        hit = scene.cameraTracer->closest(ray);
        if (!hit || !clear[hit.triangle]) break;
        ray.near = hit.distance * (1 + 1e-6f) + 0.25f * scene.tracer->surfaceOffset();
    }
    return hit;
}

/// Calls function(view, hit, cosine between the ray and the normal of what it hits) for each pixel that shows `through`
/// or a surface from behind.
template <class Function>
void forPixelsThrough(const Scene& scene, const Capture& capture, const RadianceSamples& samples,
                      const std::vector<uint32_t>& through, const Function& function) {
    std::vector<uint8_t> clear(scene.mesh.triangles.size(), 0);
    for (const uint32_t t : through) clear[t] = 1;
    parallelFor(capture.views.size(), 1, [&](size_t i) {
        const Camera& camera = capture.views[i].camera;
        const ViewGeometry& g = samples.geometry[i];
        const Vec3 eye(camera.position());
        for (int y = 0; y < g.height; ++y)
            for (int x = 0; x < g.width; ++x) {
                const uint32_t first = g.triangle[size_t(y) * size_t(g.width) + size_t(x)];
                if (first == Hit::none) continue;
                const Vec3 ray = camera.rayDirection(Vec2(float(x) + 0.5f, float(y) + 0.5f));
                if (!clear[first] && !(glm::dot(scene.mesh.faceNormal(first), ray) > leastBackCosine)) continue;
                const Hit hit = hitPast(scene, clear, {eye, ray, 0, 1e30f});
                function(i, hit, hit ? glm::dot(scene.mesh.faceNormal(hit.triangle), ray) : 0.0f);
            }
    });
}

}  // namespace

SeenBehind seenBehind(const Scene& scene, const Capture& capture, const RadianceSamples& samples,
                      const std::vector<uint32_t>& triangles) {
    std::vector<std::array<size_t, 3>> counts(capture.views.size(), {0, 0, 0});  // background, fronts, backs
    forPixelsThrough(scene, capture, samples, triangles, [&](size_t view, const Hit& hit, float along) {
        ++counts[view][!hit ? 0 : along > 0 ? 2 : 1];
    });
    std::array<size_t, 3> sum{0, 0, 0};
    for (const auto& count : counts)
        for (size_t k = 0; k < 3; ++k) sum[k] += count[k];
    const float all = float(std::max<size_t>(1, sum[0] + sum[1] + sum[2]));
    return {float(sum[2]) / all, float(sum[1]) / all};
}

SurfacePatch backSides(const Scene& scene, const Capture& capture, const RadianceSamples& samples,
                       const std::vector<uint32_t>& without, const std::vector<LightBall>& lights) {
    const Mesh& mesh = scene.mesh;
    std::vector<uint8_t> clear(mesh.triangles.size(), 0), lit = clear;
    for (const uint32_t t : without) clear[t] = 1;
    for (const LightBall& light : lights)
        for (uint32_t i = 0; i < raysFromLight; ++i) {
            const Vec2 u = r2Point(i, Vec2(0.5f));
            const float z = 1 - 2 * u.x, across = std::sqrt(1 - z * z), turn = 2 * pi * u.y;
            const Vec3 ray(across * std::cos(turn), across * std::sin(turn), z);
            const Hit hit =
                hitPast(scene, clear, {light.centre, ray, 1.05f * light.radius, reachOfLight * light.radius});
            if (hit && glm::dot(mesh.faceNormal(hit.triangle), ray) > leastBackCosine) lit[hit.triangle] = 1;
        }
    std::vector<std::vector<uint8_t>> seen(capture.views.size(), std::vector<uint8_t>(mesh.triangles.size(), 0));
    forPixelsThrough(scene, capture, samples, without, [&](size_t view, const Hit& hit, float along) {
        if (along > leastBackCosine) seen[view][hit.triangle] = 1;
    });
    // Triangles between pixels go with what is around them.
    std::vector<uint8_t> touched(mesh.vertexCount(), 0);
    for (size_t t = 0; t < mesh.triangles.size(); ++t) {
        uint8_t views = 0;
        for (const std::vector<uint8_t>& ofView : seen)
            views = uint8_t(std::min<int>(leastBackViews, views + ofView[t]));
        if (views < leastBackViews && !lit[t]) continue;
        for (const uint32_t v : mesh.triangles[t]) touched[v] = 1;
    }
    SurfacePatch patch;
    std::vector<uint32_t> number(mesh.vertexCount(), ~0u);
    for (uint32_t t = 0; t < mesh.triangles.size(); ++t) {
        const Triangle& corners = mesh.triangles[t];
        if (!std::all_of(corners.begin(), corners.end(), [&](uint32_t v) { return touched[v] != 0; })) continue;
        if (clear[t]) continue;
        for (const uint32_t v : corners) {
            if (number[v] != ~0u) continue;
            number[v] = uint32_t(patch.positions.size());
            patch.positions.push_back(mesh.positions[v] - thickness * scene.diagonal * mesh.normals[v]);
        }
        patch.triangles.push_back({number[corners[0]], number[corners[2]], number[corners[1]]});
        patch.area += mesh.triangleArea(t);
    }
    return patch;
}

}  // namespace relamp
