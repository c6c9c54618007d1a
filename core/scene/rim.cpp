#include "scene/rim.h"

#include <algorithm>
#include <array>
#include <numeric>

namespace relamp {

std::vector<uint8_t> rimVertices(const Mesh& mesh) {
    const size_t n = mesh.vertexCount();
    std::vector<uint32_t> order(n), place(n);
    std::iota(order.begin(), order.end(), 0u);
    const auto key = [&](uint32_t v) {
        return std::array<float, 3>{mesh.positions[v].x, mesh.positions[v].y, mesh.positions[v].z};
    };
    std::sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) {
        const auto ka = key(a), kb = key(b);
        return ka != kb ? ka < kb : a < b;
    });
    for (size_t i = 0; i < n; ++i)
        place[order[i]] = i > 0 && key(order[i]) == key(order[i - 1]) ? place[order[i - 1]] : order[i];
    std::vector<uint64_t> edges;
    edges.reserve(3 * mesh.triangles.size());
    for (const Triangle& t : mesh.triangles)
        for (size_t k = 0; k < 3; ++k) {
            const uint64_t a = place[t[k]], b = place[t[(k + 1) % 3]];
            if (a != b) edges.push_back(std::min(a, b) << 32 | std::max(a, b));
        }
    std::sort(edges.begin(), edges.end());
    std::vector<uint8_t> atPlace(n, 0), rim(n, 0);
    for (size_t i = 0; i < edges.size();) {
        size_t end = i;
        while (end < edges.size() && edges[end] == edges[i]) ++end;
        if (end - i == 1) atPlace[edges[i] >> 32] = atPlace[edges[i] & 0xffffffffu] = 1;
        i = end;
    }
    for (size_t v = 0; v < n; ++v) rim[v] = atPlace[place[v]];
    return rim;
}

}  // namespace relamp
