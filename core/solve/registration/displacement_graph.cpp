#include "solve/registration/displacement_graph.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <unordered_map>

#include "base/parallel.h"
#include "base/random.h"

namespace relamp {
namespace {

constexpr float sameSide = 0.5f;  ///< least cosine between the normals of places that move together

/// Nodes by the cell of a grid that they lie in.
class NodeGrid {
public:
    NodeGrid(const Mesh& mesh, float cell) : mesh_(mesh), cell_(cell) {}
    void add(uint32_t node, uint32_t vertex) {
        cells_[key(cellOf(mesh_.positions[vertex]), {0, 0, 0})].push_back({node, vertex});
    }
    /// Calls visit(node, distance) for the nodes within `reach` (at most a cell) of vertex v that face as it does.
    template <class Visit>
    void near(uint32_t v, float reach, Visit&& visit) const {
        const std::array<int64_t, 3> middle = cellOf(mesh_.positions[v]);
        for (int k = 0; k < 27; ++k) {
            const auto found = cells_.find(key(middle, {k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1}));
            if (found == cells_.end()) continue;
            for (const Node& n : found->second) {
                const float distance = glm::length(mesh_.positions[n.vertex] - mesh_.positions[v]);
                if (distance < reach && glm::dot(mesh_.normals[n.vertex], mesh_.normals[v]) > sameSide)
                    visit(n.node, distance);
            }
        }
    }

private:
    struct Node {
        uint32_t node = 0, vertex = 0;
    };
    std::array<int64_t, 3> cellOf(const Vec3& p) const {
        return {int64_t(std::floor(p.x / cell_)), int64_t(std::floor(p.y / cell_)), int64_t(std::floor(p.z / cell_))};
    }
    static uint64_t key(const std::array<int64_t, 3>& c, const std::array<int, 3>& step) {
        return mixBits(mixBits(mixBits(uint64_t(c[0] + step[0])) ^ uint64_t(c[1] + step[1])) ^
                       uint64_t(c[2] + step[2]));
    }
    const Mesh& mesh_;
    float cell_;
    std::unordered_map<uint64_t, std::vector<Node>> cells_;
};

}  // namespace

DisplacementGraph buildDisplacementGraph(const Scene& scene, float spacing) {
    const Mesh& mesh = scene.mesh;
    DisplacementGraph graph;
    // Taken in the order of their ranks, so that the nodes rest neither on the file's order nor on its axes.
    std::vector<uint32_t> order(mesh.vertexCount());
    std::iota(order.begin(), order.end(), 0u);
    std::sort(order.begin(), order.end(),
              [&](uint32_t a, uint32_t b) { return std::pair(scene.rank[a], a) < std::pair(scene.rank[b], b); });
    NodeGrid grid(mesh, 2 * spacing);
    for (const uint32_t v : order) {
        if (!scene.referenced[v]) continue;
        bool taken = false;
        grid.near(v, spacing, [&](uint32_t, float) { taken = true; });
        if (taken) continue;
        grid.add(uint32_t(graph.nodes.size()), v);
        graph.nodes.push_back(v);
    }
    graph.neighbours.resize(graph.nodes.size());
    parallelFor(graph.nodes.size(), 256, [&](size_t n) {
        std::vector<uint32_t>& to = graph.neighbours[n];
        grid.near(graph.nodes[n], 2 * spacing, [&](uint32_t other, float) {
            if (other != n) to.push_back(other);
        });
        std::sort(to.begin(), to.end());
        to.erase(std::unique(to.begin(), to.end()), to.end());
    });
    graph.shares.resize(mesh.vertexCount());
    parallelFor(mesh.vertexCount(), 1024, [&](size_t v) {
        if (!scene.referenced[v]) return;
        std::vector<std::pair<float, uint32_t>> found;
        grid.near(uint32_t(v), 2 * spacing, [&](uint32_t node, float distance) { found.push_back({distance, node}); });
        std::sort(found.begin(), found.end());
        found.resize(std::min<size_t>(found.size(), 4));
        float sum = 0;
        DisplacementGraph::Share& share = graph.shares[v];
        for (size_t k = 0; k < found.size(); ++k) {
            const float near = 1 - found[k].first / (2 * spacing);
            share.node[k] = found[k].second;
            share.weight[k] = near * near;
            sum += near * near;
        }
        if (sum > 0)
            for (float& w : share.weight) w /= sum;
    });
    return graph;
}

}  // namespace relamp
