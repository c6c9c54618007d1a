// An emitter's triangles in a tree, so that a surface point takes as few of its components as the distance allows:
// whole branches far away, triangles and parts of them near.
#pragma once
#include <optional>

#include "transport/near_field.h"

namespace relamp {

/// What an emitter shows to one point.
struct EmitterComponents {
    struct Piece {
        uint32_t begin = 0, end = 0;    ///< triangles in the tree's order; begin == end: only `corners`
        std::array<Vec3, 3> corners{};  ///< of a part of one triangle
        Vec3 centre{0};
        float area = 0;
        float factor = 0;  ///< unshadowed form factor
    };
    std::vector<Piece> components;
    float open = 0;  ///< sum of factors, at most 1
};

/// How finely an emitter is cut up.
struct CutTolerance {
    float far = 0.1f;  ///< a branch is taken whole below this ratio of radius to distance
    float coneCosine =
        0.7f;         ///< ... and when all of it faces the point, or its normals lie within the cone of this cosine
    float above = 1;  ///< ... and when its centre stands above the horizon by this fraction of its radius
    int splits = 3;   ///< times a near triangle is quartered so that samples spread evenly
};
inline constexpr CutTolerance coarseCut{0.25f, 0.7f, 0, 0};
inline constexpr CutTolerance fineCut{0.1f, 0.8f, 1, 3};

class LiveEmitterTree {
public:
    /// In depth-first order.
    struct Node {
        Vec3 centre{0}, vectorArea{0}, axis{0};
        float radius = 0, area = 0, coneCosine = -1, coneSine = 0;
        uint32_t begin = 0, end = 0,
                 right = 0;  ///< right child; the left one follows its parent; 0: a single triangle
    };
    LiveEmitterTree() = default;
    /// `convex`: whether it is, when that is known already; finding out costs a square of the number of triangles.
    explicit LiveEmitterTree(EmitterSurface surface, std::optional<bool> convex = {});
    const EmitterSurface& surface() const { return surface_; }
    bool convex() const { return convex_; }  ///< no part of its front is hidden by another part of it
    const std::vector<Node>& nodes() const { return nodes_; }
    const std::vector<uint32_t>& order() const { return order_; }         ///< triangles of the surface
    const std::vector<float>& cumulative() const { return cumulative_; }  ///< area up to each triangle in that order

    /// Cuts the tree for a point. `finest`: what a component's radius over its distance may be at most, squared, as a
    /// function of the vector to it.
    void cut(const Vec3& point, const Vec3& normal, const CutTolerance& tolerance, EmitterComponents& out) const;
    template <class Finest>
    void cut(const Vec3& point, const Vec3& normal, const CutTolerance& tolerance, const Finest& finest,
             EmitterComponents& out) const;
    /// A point of a component from u in [0,1)^2, evenly over its area; its normal.
    Vec3 pointOn(const EmitterComponents::Piece& component, const Vec2& u, Vec3& normal) const;

private:
    EmitterSurface surface_;
    std::vector<Node> nodes_;
    std::vector<uint32_t> order_;
    std::vector<float> cumulative_;  // area before and with each triangle in that order
    bool convex_ = false;

    uint32_t build(uint32_t begin, uint32_t end);
    template <class Finest>
    void addTriangle(const Vec3& point, const Vec3& normal, const std::array<Vec3, 3>& corners, float radius,
                     int splits, const Finest& finest, EmitterComponents& out) const;
};

template <class Finest>
void LiveEmitterTree::addTriangle(const Vec3& point, const Vec3& normal, const std::array<Vec3, 3>& c, float radius,
                                  int splits, const Finest& finest, EmitterComponents& out) const {
    const Vec3 centre = (c[0] + c[1] + c[2]) / 3.0f, to = centre - point;
    const float d2 = glm::dot(to, to);
    const bool sharp = radius * radius > d2 * finest(to);
    if ((splits > 0 && d2 < 16 * radius * radius) || (sharp && splits > -5)) {
        const Vec3 m[3] = {(c[0] + c[1]) / 2.0f, (c[1] + c[2]) / 2.0f, (c[2] + c[0]) / 2.0f};
        for (const auto& part : {std::array{c[0], m[0], m[2]}, std::array{m[0], c[1], m[1]},
                                 std::array{m[2], m[1], c[2]}, std::array{m[0], m[1], m[2]}})
            addTriangle(point, normal, part, radius / 2, splits - 1, finest, out);
        return;
    }
    const float factor = triangleFormFactor(point, normal, c, surface_.twoSided);
    if (!(factor > 0)) return;
    out.components.push_back({0, 0, c, centre, glm::length(glm::cross(c[1] - c[0], c[2] - c[0])) / 2, factor});
    out.open += factor;
}

template <class Finest>
void LiveEmitterTree::cut(const Vec3& point, const Vec3& normal, const CutTolerance& tolerance, const Finest& finest,
                          EmitterComponents& out) const {
    out.components.clear();
    out.open = 0;
    if (nodes_.empty()) return;
    uint32_t stack[64];
    int depth = 0;
    stack[depth++] = 0;
    while (depth) {
        const uint32_t at = stack[--depth];
        const Node& n = nodes_[at];
        const Vec3 to = n.centre - point;
        const float d2 = glm::dot(to, to), height = glm::dot(to, normal), r = n.radius;
        if (height < -r) continue;
        const float facing = -glm::dot(to, n.axis);
        // All of it faces away, or all of it towards the point: by the cone of its normals, widened by the angle the
        // branch covers.
        const float rim = n.coneSine * std::sqrt(d2) + r;
        const bool cone = n.coneCosine > 0;
        if (!surface_.twoSided && cone && facing < -rim) continue;
        const bool even = !n.right || n.coneCosine > tolerance.coneCosine || (cone && std::abs(facing) > rim);
        const bool whole = even && height > tolerance.above * r && r * r < tolerance.far * tolerance.far * d2 &&
                           r * r <= d2 * finest(to);
        if (whole) {
            float toward = surface_.twoSided ? std::abs(glm::dot(to, n.vectorArea)) : -glm::dot(to, n.vectorArea);
            // Across the edge of what faces the point only a part counts: the mean of max(0, cosine) over normals
            // spread evenly about their mean.
            if (const float width = 0.75f * n.coneSine * std::sqrt(d2) * n.area;
                !surface_.twoSided && n.right && std::abs(toward) < width)
                toward = (toward + width) * (toward + width) / (4 * width);
            if (!(toward > 0)) continue;
            const float factor = height * toward / (pi * d2 * d2);
            out.components.push_back({n.begin, n.end, {}, n.centre, n.area, factor});
            out.open += factor;
        } else if (n.right) {
            stack[depth++] = n.right;
            stack[depth++] = at + 1;
        } else {
            addTriangle(point, normal, surface_.corners[order_[n.begin]], r, tolerance.splits, finest, out);
        }
    }
    if (out.open > 1) {
        for (EmitterComponents::Piece& p : out.components) p.factor /= out.open;
        out.open = 1;
    }
}

}  // namespace relamp
