#include "scene/box_tree.h"

#include <numeric>

#include "base/box.h"
#include "base/error.h"

namespace relamp {
namespace {

constexpr int bins = 16;

struct Builder {
    std::vector<Box> box;
    std::vector<Vec3> centre;
    std::vector<uint32_t> order;
    const Mesh& mesh;
    BoxTree& out;

    static float areaOf(const Box& b) {
        if (b.empty()) return 0;
        const Vec3 e = b.max - b.min;
        return e.x * e.y + e.y * e.z + e.z * e.x;
    }

    static void join(Box& a, const Box& b) {
        a.min = glm::min(a.min, b.min);
        a.max = glm::max(a.max, b.max);
    }

    void leaf(BoxTree::Node& node, uint32_t begin, uint32_t end) {
        node.leaf = uint32_t(out.triangles.size() / 3) << 3 | (end - begin);
        for (uint32_t i = begin; i < end; ++i) {
            const Triangle& t = mesh.triangles[order[i]];
            const Vec3 a = mesh.positions[t[0]];
            out.triangles.emplace_back(a, 0);
            out.triangles.emplace_back(mesh.positions[t[1]] - a, 0);
            out.triangles.emplace_back(mesh.positions[t[2]] - a, 0);
        }
    }

    /// Where to part order[begin, end).
    uint32_t split(uint32_t begin, uint32_t end) {
        Box places;
        for (uint32_t i = begin; i < end; ++i) places.grow(centre[order[i]]);
        const Vec3 size = places.size();
        const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
        const uint32_t middle = (begin + end) / 2;
        if (!(size[axis] > 0)) return middle;
        const auto binOf = [&](uint32_t t) {
            return std::clamp(int(float(bins) * (centre[t][axis] - places.min[axis]) / size[axis]), 0, bins - 1);
        };
        Box bound[bins];
        uint32_t count[bins] = {};
        for (uint32_t i = begin; i < end; ++i) {
            const int b = binOf(order[i]);
            join(bound[b], box[order[i]]);
            ++count[b];
        }
        float rightCost[bins] = {};
        Box all;
        uint32_t sum = 0;
        for (int b = bins - 1; b > 0; --b) {
            join(all, bound[b]);
            rightCost[b] = areaOf(all) * float(sum += count[b]);
        }
        all = {};
        sum = 0;
        int best = -1;
        float least = 0;
        for (int b = 0; b + 1 < bins; ++b) {
            join(all, bound[b]);
            sum += count[b];
            const float cost = areaOf(all) * float(sum) + rightCost[b + 1];
            if (sum == 0 || sum == end - begin || (best >= 0 && cost >= least)) continue;
            best = b;
            least = cost;
        }
        if (best < 0) return middle;
        const auto right = std::stable_partition(order.begin() + begin, order.begin() + end,
                                                 [&](uint32_t t) { return binOf(t) <= best; });
        return uint32_t(right - order.begin());
    }

    void build(uint32_t begin, uint32_t end, int depth) {
        const size_t at = out.nodes.size();
        out.nodes.emplace_back();
        Box bound;
        for (uint32_t i = begin; i < end; ++i) join(bound, box[order[i]]);
        BoxTree::Node node;
        node.min = bound.min;
        node.max = bound.max;
        if (end - begin <= BoxTree::perLeaf) {
            leaf(node, begin, end);
        } else {
            const uint32_t middle = depth < 60 ? split(begin, end) : (begin + end) / 2;
            build(begin, middle, depth + 1);
            build(middle, end, depth + 1);
        }
        node.skip = uint32_t(out.nodes.size());
        out.nodes[at] = node;
    }
};

bool meets(const BoxTree::Node& n, const Vec3& origin, const Vec3& inverse, float near, float far) {
    const Vec3 a = (n.min - origin) * inverse, b = (n.max - origin) * inverse;
    const Vec3 low = glm::min(a, b), high = glm::max(a, b);
    const float enter = std::max(std::max(low.x, low.y), std::max(low.z, near));
    const float leave = std::min(std::min(high.x, high.y), std::min(high.z, far));
    return enter <= leave * 1.000001f;
}

/// Moeller and Trumbore 1997; an edge belongs to both of its triangles.
bool hits(const Vec4* t, const Ray& ray) {
    const Vec3 e1(t[1]), e2(t[2]), p = glm::cross(ray.direction, e2);
    const float determinant = glm::dot(e1, p);
    if (determinant == 0) return false;
    const float inverse = 1 / determinant;
    const Vec3 s = ray.origin - Vec3(t[0]);
    const float u = glm::dot(s, p) * inverse;
    const Vec3 q = glm::cross(s, e1);
    const float v = glm::dot(ray.direction, q) * inverse, at = glm::dot(e2, q) * inverse;
    constexpr float slack = 1e-6f;
    return u >= -slack && v >= -slack && u + v <= 1 + slack && at >= ray.near && at <= ray.far;
}

}  // namespace

BoxTree BoxTree::of(const Mesh& mesh) {
    BoxTree out;
    Builder builder{{}, {}, {}, mesh, out};
    builder.box.resize(mesh.triangles.size());
    builder.centre.resize(mesh.triangles.size());
    size_t light = 0;
    for (uint32_t t = 0; t < mesh.triangles.size(); ++t) {
        while (light < mesh.shadowless.size() && mesh.shadowless[light] < t) ++light;
        if (light < mesh.shadowless.size() && mesh.shadowless[light] == t) continue;
        for (const uint32_t v : mesh.triangles[t]) builder.box[t].grow(mesh.positions[v]);
        builder.centre[t] = builder.box[t].centre();
        builder.order.push_back(t);
    }
    if (builder.order.empty()) return out;
    if (builder.order.size() >= 1u << 29) throw Error("{} triangles, expected less than 2^29", builder.order.size());
    out.nodes.reserve(builder.order.size());
    out.triangles.reserve(3 * builder.order.size());
    builder.build(0, uint32_t(builder.order.size()), 0);
    return out;
}

bool BoxTree::occluded(const Ray& ray) const {
    Vec3 inverse;
    for (int k = 0; k < 3; ++k) {
        const float d = ray.direction[k];
        inverse[k] = 1 / (std::abs(d) < 1e-20f ? std::copysign(1e-20f, d) : d);
    }
    for (uint32_t i = 0; i < nodes.size();) {
        const Node& n = nodes[i];
        if (!meets(n, ray.origin, inverse, ray.near, ray.far)) {
            i = n.skip;
            continue;
        }
        for (uint32_t t = n.leaf >> 3; t < (n.leaf >> 3) + (n.leaf & 7); ++t)
            if (hits(&triangles[3 * t], ray)) return true;
        ++i;
    }
    return false;
}

}  // namespace relamp
