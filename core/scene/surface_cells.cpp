#include "scene/surface_cells.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <queue>
#include <tuple>

#include "base/random.h"

namespace relamp {
namespace {

/// How alike two neighbours are: 1 on one even surface, 0 across a change of hue or a hollow.
class Likeness {
public:
    Likeness(const Scene& scene, const std::vector<Rgb>& colour, const CellOptions& options)
        : scene_(scene), options_(options), chroma_(colour.size()), known_(colour.size()) {
        for (size_t v = 0; v < colour.size(); ++v) {
            known_[v] = colour[v].x > 0 && colour[v].y > 0 && colour[v].z > 0;
            if (known_[v]) chroma_[v] = {std::log(colour[v].x / colour[v].y), std::log(colour[v].z / colour[v].y)};
        }
    }
    double of(uint32_t a, uint32_t b) const {
        const Vec3 step = scene_.mesh.positions[b] - scene_.mesh.positions[a];
        const float length = glm::length(step);
        if (!(length > 0)) return 1;
        const float turn = glm::dot(scene_.mesh.normals[b] - scene_.mesh.normals[a], step) / length,
                    hollow = std::max(0.0f, -turn) / options_.hollow,
                    hue = known_[a] && known_[b] ? glm::distance(chroma_[a], chroma_[b]) / options_.hue : 0;
        return std::exp(-double(hollow * hollow + hue * hue));
    }

private:
    const Scene& scene_;
    const CellOptions& options_;
    std::vector<Vec2> chroma_;
    std::vector<uint8_t> known_;
};

/// Seeds, by a number drawn from each vertex's place.
std::vector<uint32_t> seedsOf(const Scene& scene, const std::vector<uint8_t>& skip, const CellOptions& options) {
    std::vector<uint32_t> seeds;
    size_t usable = 0;
    for (uint32_t v = 0; v < skip.size(); ++v) usable += scene.referenced[v] && !skip[v];
    const float part =
        std::min(1.0f / float(options.vertices), float(options.most) / float(std::max<size_t>(1, usable)));
    for (uint32_t v = 0; v < skip.size(); ++v)
        if (scene.referenced[v] && !skip[v] && unitFloat(mixBits(mixBits(options.seed) ^ scene.rank[v])) < part)
            seeds.push_back(v);
    return seeds;
}

}  // namespace

SurfaceCells surfaceCells(const Scene& scene, const std::vector<Rgb>& colour, const std::vector<uint8_t>& skip,
                          const CellOptions& options) {
    const VertexGraph& graph = scene.graph;
    const Likeness alike(scene, colour, options);
    const std::vector<uint32_t> seeds = seedsOf(scene, skip, options);
    SurfaceCells cells{std::vector<uint32_t>(scene.mesh.vertexCount(), noCell), uint32_t(seeds.size()), {}};
    struct Reached {
        float distance = 0;
        uint32_t rank = 0, vertex = 0, cell = 0;  // rank: of the seed; decides between equals
        bool operator<(const Reached& other) const {
            return std::tie(distance, rank) > std::tie(other.distance, other.rank);
        }
    };
    std::priority_queue<Reached> queue;
    for (uint32_t i = 0; i < seeds.size(); ++i) queue.push({0, scene.rank[seeds[i]], seeds[i], i});
    while (!queue.empty()) {
        const Reached at = queue.top();
        queue.pop();
        if (cells.cellOf[at.vertex] != noCell) continue;
        cells.cellOf[at.vertex] = at.cell;
        for (uint32_t e = graph.start[at.vertex]; e < graph.start[at.vertex + 1]; ++e) {
            const uint32_t to = graph.to[e];
            if (cells.cellOf[to] != noCell || skip[to]) continue;
            const float length = glm::distance(scene.mesh.positions[at.vertex], scene.mesh.positions[to]);
            queue.push({at.distance + length * float(5 - 4 * alike.of(at.vertex, to)), at.rank, to, at.cell});
        }
    }
    std::map<std::pair<uint32_t, uint32_t>, double> across;
    for (uint32_t v = 0; v < cells.cellOf.size(); ++v)
        for (uint32_t e = graph.start[v]; e < graph.start[v + 1]; ++e) {
            const uint32_t a = cells.cellOf[v], b = cells.cellOf[graph.to[e]];
            if (a < b && b != noCell) across[{a, b}] += std::max(0.05, alike.of(v, graph.to[e]));
        }
    for (const auto& [pair, sum] : across) cells.borders.push_back({pair.first, pair.second, sum});
    return cells;
}

}  // namespace relamp
