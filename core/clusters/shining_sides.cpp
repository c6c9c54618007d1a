#include "clusters/shining_sides.h"

#include <algorithm>

#include "clusters/patches.h"

namespace relamp {
namespace {

/// Vertices marked 1 in `free` that are connected with the emitter's by others of them.
std::vector<uint32_t> connectedWith(const Scene& scene, std::vector<uint8_t> free, const EmitterCluster& e) {
    std::vector<uint32_t> found;
    const auto visitNeighbours = [&](uint32_t v) {
        for (uint32_t k = scene.graph.start[v]; k < scene.graph.start[v + 1]; ++k) {
            const uint32_t u = scene.graph.to[k];
            if (!free[u]) continue;
            free[u] = 0;
            found.push_back(u);
        }
    };
    for (const uint32_t v : e.vertices) visitNeighbours(v);
    for (size_t i = 0; i < found.size(); ++i) visitNeighbours(found[i]);
    return found;
}

void addVertices(const Scene& scene, const std::vector<uint32_t>& added, EmitterCluster& e) {
    std::vector<float> levels(scene.mesh.vertexCount(), 1);
    std::vector<uint8_t> mine(levels.size(), 0);
    for (size_t k = 0; k < e.level.size(); ++k) levels[e.vertices[k]] = e.level[k];
    e.vertices.insert(e.vertices.end(), added.begin(), added.end());
    std::sort(e.vertices.begin(), e.vertices.end());
    for (const uint32_t v : e.vertices) mine[v] = 1;
    if (!e.level.empty()) {
        e.level.clear();
        for (const uint32_t v : e.vertices) e.level.push_back(levels[v]);
        rebuildPattern(scene.mesh, e);
    }
    e.triangles.clear();
    for (uint32_t t = 0; t < scene.mesh.triangles.size(); ++t) {
        const Triangle& at = scene.mesh.triangles[t];
        if (mine[at[0]] && mine[at[1]] && mine[at[2]]) e.triangles.push_back(t);
    }
    measureTriangles(scene, e);
}

}  // namespace

void letSidesShine(const Scene& scene, const std::vector<uint32_t>& shining, EmitterClusters& clusters) {
    if (shining.empty()) return;
    std::vector<uint8_t> free(scene.mesh.vertexCount(), 0);
    for (const uint32_t v : shining)
        if (v < free.size() && clusters.emitterOfVertex[v] < 0) free[v] = 1;
    bool changed = false;
    for (std::vector<EmitterCluster>* list : {&clusters.emitters, &clusters.candidates})
        for (EmitterCluster& e : *list) {
            if (e.fitted || e.unobserved) continue;
            const std::vector<uint32_t> added = connectedWith(scene, free, e);
            if (added.empty()) continue;
            for (const uint32_t v : added) free[v] = 0;
            addVertices(scene, added, e);
            changed = true;
        }
    if (changed) indexEmitters(scene, clusters);
}

void letBacksShine(const std::vector<uint32_t>& bothSides, EmitterClusters& clusters) {
    if (bothSides.empty()) return;
    for (std::vector<EmitterCluster>* list : {&clusters.emitters, &clusters.candidates})
        for (EmitterCluster& e : *list) {
            const auto marked = std::count_if(e.vertices.begin(), e.vertices.end(), [&](uint32_t v) {
                return std::binary_search(bothSides.begin(), bothSides.end(), v);
            });
            if (!e.fitted && !e.unobserved && 2 * size_t(marked) > e.vertices.size()) e.twoSided = true;
        }
}

}  // namespace relamp
