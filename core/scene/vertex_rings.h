// Rings of neighbours about vertices.
#pragma once
#include "scene/mesh.h"

namespace relamp {

/// Per vertex how many edges it lies from those in `reached`, -1 beyond `last`; `reached` gains those up to there, ring
/// by ring. O(vertices reached).
inline std::vector<int> ringsAbout(const VertexGraph& graph, int last, std::vector<uint32_t>& reached) {
    std::vector<int> rings(graph.start.size() - 1, -1);
    for (const uint32_t v : reached) rings[v] = 0;
    for (size_t i = 0; i < reached.size(); ++i) {
        const uint32_t v = reached[i];
        if (rings[v] == last) continue;
        for (uint32_t k = graph.start[v]; k < graph.start[v + 1]; ++k)
            if (rings[graph.to[k]] < 0) {
                rings[graph.to[k]] = rings[v] + 1;
                reached.push_back(graph.to[k]);
            }
    }
    return rings;
}

}  // namespace relamp
