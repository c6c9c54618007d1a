#include "relight/live/levels.h"

#include <algorithm>
#include <array>

#include "base/parallel.h"

namespace relamp {
namespace {

constexpr uint32_t nobody = ~0u;
constexpr size_t mostParents = 6;
constexpr float likeNormals = 0.7f;  // least cosine between a vertex's normal and a parent's

/// Vertices of a level and which of them are neighbours.
struct Level {
    std::vector<uint32_t> vertices;
    std::vector<uint32_t> start, to;  // by place in `vertices`
    std::span<const uint32_t> around(size_t i) const {
        return std::span(to).subspan(start[i], start[i + 1] - start[i]);
    }
};

struct Choice {
    std::vector<uint32_t> owner;  // per place: place of the chosen neighbour, its own when chosen
    std::vector<uint32_t> chosen;
};

/// No two chosen vertices are neighbours, and every other one has a chosen neighbour.
Choice choose(const Level& level) {
    Choice out;
    out.owner.assign(level.vertices.size(), nobody);
    for (uint32_t i = 0; i < level.vertices.size(); ++i) {
        if (out.owner[i] != nobody) continue;
        out.owner[i] = i;
        out.chosen.push_back(i);
        for (const uint32_t j : level.around(i))
            if (out.owner[j] == nobody) out.owner[j] = i;
    }
    return out;
}

/// The chosen vertices, neighbours where the vertices they own are.
Level coarser(const Level& level, const Choice& choice) {
    std::vector<uint32_t> place(level.vertices.size(), nobody);
    Level out;
    for (const uint32_t i : choice.chosen) {
        place[i] = uint32_t(out.vertices.size());
        out.vertices.push_back(level.vertices[i]);
    }
    std::vector<std::pair<uint32_t, uint32_t>> edges;
    for (uint32_t i = 0; i < level.vertices.size(); ++i)
        for (const uint32_t j : level.around(i))
            if (choice.owner[i] != choice.owner[j]) edges.emplace_back(place[choice.owner[i]], place[choice.owner[j]]);
    std::sort(edges.begin(), edges.end());
    edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
    out.start.assign(out.vertices.size() + 1, 0);
    for (const auto& [a, b] : edges) {
        ++out.start[a + 1];
        out.to.push_back(b);
    }
    for (size_t i = 0; i < out.vertices.size(); ++i) out.start[i + 1] += out.start[i];
    return out;
}

/// The smallest weights of sum 1 that give the place of `v` within its tangent plane; none when that takes a vertex far
/// outside the others, or they lie in a line that misses it.
size_t weigh(const Mesh& mesh, uint32_t v, std::span<const uint32_t> near,
             std::array<LiveLevels::Parent, mostParents>& out) {
    if (near.size() < 3) return 0;
    const Vec3 normal = mesh.normals[v];
    const Mat3 frame = frameAround(normal);
    float scale = 0;
    for (const uint32_t u : near) scale = std::max(scale, glm::length(mesh.positions[u] - mesh.positions[v]));
    if (!(scale > 0)) return 0;
    // Rows 1, x, y over the parents; weights are its pseudoinverse times (1, 0, 0).
    Mat3 gram(0);
    std::array<Vec3, mostParents> row;
    for (size_t k = 0; k < near.size(); ++k) {
        const Vec3 local = glm::transpose(frame) * (mesh.positions[near[k]] - mesh.positions[v]) / scale;
        row[k] = Vec3(1, local.x, local.y);
        gram += glm::outerProduct(row[k], row[k]);
    }
    if (!(std::abs(glm::determinant(gram)) > 1e-3f)) return 0;
    const Vec3 solved = glm::inverse(gram) * Vec3(1, 0, 0);
    for (size_t k = 0; k < near.size(); ++k) {
        out[k] = {near[k], glm::dot(row[k], solved)};
        if (out[k].weight < -0.15f) return 0;
    }
    return near.size();
}

}  // namespace

LiveLevels::LiveLevels(const Mesh& mesh, const VertexGraph& graph, std::span<const uint8_t> wanted, size_t fewest) {
    const size_t n = mesh.vertexCount();
    Level level;
    std::vector<uint32_t> place(n, nobody);
    for (uint32_t v = 0; v < n; ++v)
        if (wanted[v]) {
            place[v] = uint32_t(level.vertices.size());
            level.vertices.push_back(v);
        }
    level.start.push_back(0);
    for (const uint32_t v : level.vertices) {
        for (uint32_t i = graph.start[v]; i < graph.start[v + 1]; ++i)
            if (wanted[graph.to[i]]) level.to.push_back(place[graph.to[i]]);
        level.start.push_back(uint32_t(level.to.size()));
    }
    start_.assign(n + 1, 0);
    std::vector<std::array<Parent, mostParents>> found(n);
    std::vector<uint8_t> count(n, 0);
    while (true) {
        const Choice choice = choose(level);
        if (choice.chosen.size() < fewest || 2 * choice.chosen.size() > level.vertices.size()) break;
        const Level next = coarser(level, choice);
        std::vector<uint32_t> nextPlace(level.vertices.size(), nobody), rest;
        for (uint32_t k = 0; k < choice.chosen.size(); ++k) nextPlace[choice.chosen[k]] = k;
        for (uint32_t i = 0; i < level.vertices.size(); ++i)
            if (choice.owner[i] != i) rest.push_back(i);
        parallelFor(rest.size(), 1024, [&](size_t r) {
            const uint32_t i = rest[r], v = level.vertices[i], owner = nextPlace[choice.owner[i]];
            std::vector<std::pair<float, uint32_t>> near;
            const auto offer = [&](uint32_t u) {
                if (glm::dot(mesh.normals[u], mesh.normals[v]) < likeNormals) return;
                const Vec3 to = mesh.positions[u] - mesh.positions[v];
                near.emplace_back(glm::dot(to, to), u);
            };
            offer(next.vertices[owner]);
            for (const uint32_t k : next.around(owner)) offer(next.vertices[k]);
            std::sort(near.begin(), near.end());
            std::array<uint32_t, mostParents> nearest;
            const size_t most = std::min(near.size(), mostParents);
            for (size_t k = 0; k < most; ++k) nearest[k] = near[k].second;
            // As few as enclose the vertex.
            for (size_t take = 3; take <= most && !count[v]; ++take)
                count[v] = uint8_t(weigh(mesh, v, std::span(nearest).first(take), found[v]));
        });
        std::vector<uint32_t> fine;
        for (const uint32_t i : rest) fine.push_back(level.vertices[i]);
        sets_.push_back(std::move(fine));
        level = next;
    }
    if (sets_.empty()) return;
    sets_.push_back(level.vertices);
    std::reverse(sets_.begin(), sets_.end());
    for (size_t v = 0; v < n; ++v) {
        parents_.insert(parents_.end(), found[v].begin(), found[v].begin() + count[v]);
        start_[v + 1] = uint32_t(parents_.size());
    }
}

}  // namespace relamp
