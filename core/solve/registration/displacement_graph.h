// A smooth displacement of a surface along its normals: values at a few nodes, between them interpolated.
#pragma once
#include <array>
#include <vector>

#include "scene/scene.h"

namespace relamp {

/// Nodes are vertices of the mesh about `spacing` apart. A vertex takes the weighted mean of up to four nodes near it
/// whose surface faces the same way.
struct DisplacementGraph {
    struct Share {
        std::array<uint32_t, 4> node{};
        std::array<float, 4> weight{};  ///< add up to 1; all 0 for a vertex without a node
    };
    std::vector<uint32_t> nodes;                    ///< vertices
    std::vector<std::vector<uint32_t>> neighbours;  ///< of each node, ascending
    std::vector<Share> shares;                      ///< of each vertex

    /// Displacement of vertex v from those of the nodes.
    double at(uint32_t v, const std::vector<double>& ofNodes) const {
        double sum = 0;
        for (size_t k = 0; k < 4; ++k) sum += double(shares[v].weight[k]) * ofNodes[shares[v].node[k]];
        return sum;
    }
};

/// `spacing` in metres. Cost O(vertices).
DisplacementGraph buildDisplacementGraph(const Scene& scene, float spacing);

}  // namespace relamp
