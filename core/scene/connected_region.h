// Regions of vertices that hang together.
#pragma once
#include "scene/mesh.h"

namespace relamp {

/// Connected vertices for which `joins(vertex)` holds, from `seed` on, which is not asked; marks them in `visited` (per
/// vertex). O(vertices of the region).
template <class Joins>
std::vector<uint32_t> connectedRegion(const VertexGraph& graph, uint32_t seed, std::vector<uint8_t>& visited,
                                      Joins&& joins) {
    std::vector<uint32_t> region(1, seed);
    visited[seed] = 1;
    for (size_t i = 0; i < region.size(); ++i)
        for (uint32_t e = graph.start[region[i]]; e < graph.start[region[i] + 1]; ++e) {
            const uint32_t to = graph.to[e];
            if (visited[to] || !joins(to)) continue;
            visited[to] = 1;
            region.push_back(to);
        }
    return region;
}

}  // namespace relamp
