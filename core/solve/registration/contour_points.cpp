#include "solve/registration/contour_points.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include "base/parallel.h"
#include "solve/registration/step_edge.h"

namespace relamp {
namespace {

constexpr float contourInside = 1.5f, contourOutside = 2.0f;  ///< pixels from the outline: what lies there is looked at
constexpr float contourNoise = 0.03f;                         ///< of a profile's value, relative to its mean
constexpr float contourGap = 6;  ///< pixels at the surface's distance: what lies behind an outline is farther away

struct Edge {
    std::array<uint32_t, 2> vertex{};
    std::array<uint32_t, 2> triangle{};
};

/// Edges between two triangles, in the order of their vertices.
std::vector<Edge> innerEdges(const Mesh& mesh) {
    struct Side {
        uint32_t a, b, triangle;
    };
    std::vector<Side> sides;
    sides.reserve(3 * mesh.triangles.size());
    for (uint32_t t = 0; t < mesh.triangles.size(); ++t)
        for (size_t k = 0; k < 3; ++k) {
            const uint32_t a = mesh.triangles[t][k], b = mesh.triangles[t][(k + 1) % 3];
            sides.push_back({std::min(a, b), std::max(a, b), t});
        }
    std::sort(sides.begin(), sides.end(), [](const Side& x, const Side& y) {
        return std::tie(x.a, x.b, x.triangle) < std::tie(y.a, y.b, y.triangle);
    });
    std::vector<Edge> edges;
    for (size_t k = 0; k + 1 < sides.size(); ++k)
        if (sides[k].a == sides[k + 1].a && sides[k].b == sides[k + 1].b)
            edges.push_back({{sides[k].a, sides[k].b}, {sides[k].triangle, sides[k + 1].triangle}});
    return edges;
}

class ContoursOfView {
public:
    ContoursOfView(uint32_t index, const View& view, const Camera& camera, const Mesh& mesh, const RayTracer& tracer,
                   float floor)
        : index_(index),
          view_(view),
          camera_(camera),
          mesh_(mesh),
          tracer_(tracer),
          floor_(floor),
          pixel_(float(1 / std::min(camera.focalX, camera.focalY))) {}

    /// The edge's point, where it is an outline that the photograph shows.
    std::optional<ContourPoint> at(const Edge& edge) const {
        const Vec3 eye(camera_.position());
        const Vec3 middle = 0.5f * (mesh_.positions[edge.vertex[0]] + mesh_.positions[edge.vertex[1]]);
        const Vec3 toEye = eye - middle;
        if ((glm::dot(mesh_.faceNormal(edge.triangle[0]), toEye) > 0) ==
            (glm::dot(mesh_.faceNormal(edge.triangle[1]), toEye) > 0))
            return {};
        const float distance = glm::length(toEye);
        const Vec3 sum = mesh_.normals[edge.vertex[0]] + mesh_.normals[edge.vertex[1]];
        const std::optional<Vec2> from = camera_.project(DVec3(middle));
        const float length = glm::length(sum);
        if (!from || length < 1) return {};
        const std::optional<Vec2> to = camera_.project(DVec3(middle + sum * (distance * pixel_ / length)));
        if (!to) return {};
        const Vec2 along = *to - *from;
        if (glm::length(along) < 0.5f) return {};
        ContourPoint point{index_, edge.vertex, along / glm::length(along), 0};
        if (!isOutline(middle, sum / length, *from, point.outward, distance)) return {};
        const std::optional<Profile> profile = profileAcross(view_, *from, point.outward, floor_);
        if (!profile) return {};
        const std::optional<float> step = findStep(*profile, contourNoise);
        if (!step) return {};
        point.offset = *step - outlineAlong(*from, point.outward, distance);
        return point;
    }

private:
    /// Distance along the ray through a place in the photograph, infinite where nothing is hit.
    float depthAt(const Vec2& p) const {
        const Hit hit = tracer_.closest({Vec3(camera_.position()), camera_.rayDirection(p)});
        return hit ? hit.distance : std::numeric_limits<float>::infinity();
    }
    /// Whether the camera sees a place a pixel off the surface, and past it something farther away than the surface.
    bool isOutline(const Vec3& middle, const Vec3& normal, const Vec2& p, const Vec2& outward, float distance) const {
        const float far = contourGap * pixel_ * distance;
        const Vec3 eye(camera_.position()), beside = middle + normal * (pixel_ * distance);
        const Vec3 towardEye = eye - beside;
        const float length = glm::length(towardEye);
        return depthAt(p - contourInside * outward) < distance + far &&
               depthAt(p + contourOutside * outward) > distance + far &&
               !tracer_.occluded({beside, towardEye / length, 0, length});
    }
    /// Where the mesh ends along `outward`, pixels from p: edges of a jagged outline lie a little inside it.
    float outlineAlong(const Vec2& p, const Vec2& outward, float distance) const {
        float surface = -contourInside, beyond = contourOutside;
        for (int k = 0; k < 6; ++k) {
            const float t = 0.5f * (surface + beyond);
            (depthAt(p + t * outward) < distance + contourGap * pixel_ * distance ? surface : beyond) = t;
        }
        return 0.5f * (surface + beyond);
    }

    uint32_t index_;
    const View& view_;
    const Camera& camera_;
    const Mesh& mesh_;
    const RayTracer& tracer_;
    float floor_, pixel_;
};

}  // namespace

std::vector<ContourPoint> findContours(const std::vector<View>& views, const std::vector<Camera>& cameras,
                                       const Mesh& mesh, const RayTracer& tracer, float floor,
                                       const Progress& progress) {
    const std::vector<Edge> edges = innerEdges(mesh);
    std::vector<ContourPoint> points;
    for (uint32_t i = 0; i < views.size(); ++i) {
        progress.check();
        const ContoursOfView contours(i, views[i], cameras[i], mesh, tracer, floor);
        constexpr size_t block = 4096;
        std::vector<std::vector<ContourPoint>> parts((edges.size() + block - 1) / block);
        parallelBlocks(edges.size(), block, [&](size_t begin, size_t end) {
            for (size_t k = begin; k < end; ++k)
                if (const std::optional<ContourPoint> found = contours.at(edges[k]))
                    parts[begin / block].push_back(*found);
        });
        for (const std::vector<ContourPoint>& part : parts) points.insert(points.end(), part.begin(), part.end());
    }
    return points;
}

}  // namespace relamp
