#include "clusters/moved_emitters.h"

#include <algorithm>

#include "clusters/patches.h"

namespace relamp {
namespace {

/// Moved vertices that are connected with the emitter's.
std::vector<uint32_t> movedWith(const Scene& scene, const std::vector<uint8_t>& moved, const EmitterCluster& e) {
    std::vector<uint8_t> visited(moved.size(), 0);
    std::vector<uint32_t> found;
    const auto visit = [&](uint32_t v) {
        if (!moved[v] || visited[v]) return;
        visited[v] = 1;
        found.push_back(v);
    };
    for (const uint32_t v : e.vertices) visit(v);
    for (size_t i = 0; i < found.size(); ++i)
        for (uint32_t k = scene.graph.start[found[i]]; k < scene.graph.start[found[i] + 1]; ++k)
            visit(scene.graph.to[k]);
    return found;
}

}  // namespace

void shineAsMoved(const Scene& scene, const std::vector<MeshMend::MovedVertex>& moved, EmitterClusters& clusters) {
    if (moved.empty()) return;
    std::vector<uint8_t> isMoved(scene.mesh.vertexCount(), 0);
    for (const MeshMend::MovedVertex& m : moved)
        if (m.vertex < isMoved.size()) isMoved[m.vertex] = 1;
    bool changed = false;
    for (size_t i = 0; i < clusters.emitters.size(); ++i) {
        EmitterCluster& e = clusters.emitters[i];
        if (e.fitted || e.unobserved) continue;
        const std::vector<uint32_t> with = movedWith(scene, isMoved, e);
        std::vector<uint8_t> mine(scene.mesh.vertexCount(), 0);
        for (const uint32_t v : e.vertices) mine[v] = 1;
        std::vector<uint32_t> added;
        for (const uint32_t v : with)
            if (!mine[v] && clusters.emitterOfVertex[v] < 0) added.push_back(v);
        if (added.empty() || 2 * added.size() > with.size()) continue;
        std::vector<float> levels(scene.mesh.vertexCount(), 1);
        for (size_t k = 0; k < e.level.size(); ++k) levels[e.vertices[k]] = e.level[k];
        e.vertices.insert(e.vertices.end(), added.begin(), added.end());
        std::sort(e.vertices.begin(), e.vertices.end());
        if (!e.level.empty()) {
            e.level.clear();
            for (const uint32_t v : e.vertices) e.level.push_back(levels[v]);
            rebuildPattern(scene.mesh, e);
        }
        for (const uint32_t v : added) mine[v] = 1;
        e.triangles.clear();
        for (uint32_t t = 0; t < scene.mesh.triangles.size(); ++t) {
            const Triangle& at = scene.mesh.triangles[t];
            if (mine[at[0]] && mine[at[1]] && mine[at[2]]) e.triangles.push_back(t);
        }
        measureTriangles(scene, e);
        changed = true;
    }
    if (changed) indexEmitters(scene, clusters);
}

}  // namespace relamp
