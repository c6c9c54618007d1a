// A tree of boxes over triangles in flat arrays, for devices that trace their own rays. The processor traces with
// Embree (scene/ray_tracer).
#pragma once
#include <vector>

#include "scene/mesh.h"
#include "scene/ray_tracer.h"

namespace relamp {

/// Nodes in depth-first order: the one behind an inner node is its left child, `skip` is the first one outside its
/// branch. A walk needs no stack: to the next node where the ray meets the box, to `skip` where not.
struct BoxTree {
    struct Node {
        Vec3 min{0};
        uint32_t skip = 0;
        Vec3 max{0};
        uint32_t leaf = 0;  ///< first triangle x 8 + number of them; 0: an inner node
    };
    static_assert(sizeof(Node) == 32);
    static constexpr uint32_t perLeaf = 4;
    std::vector<Node> nodes;
    std::vector<Vec4> triangles;  ///< three each: a corner and the edges to the other two; w is not used

    /// Triangles of `mesh` but its shadowless ones. Splits by surface area over 16 bins. Cost: about a microsecond a
    /// triangle.
    static BoxTree of(const Mesh& mesh);
    /// Whether a triangle lies on the ray. As RayTracer::occluded, with other rounding at edges.
    bool occluded(const Ray& ray) const;
};

}  // namespace relamp
