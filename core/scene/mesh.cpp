#include "scene/mesh.h"

#include <cstring>
#include <unordered_map>

#include "base/random.h"

namespace relamp {
namespace {

/// Neighbours ascending, each once. An edge may be given more than once.
VertexGraph graphOf(const std::vector<std::pair<uint32_t, uint32_t>>& edges, size_t vertices) {
    std::vector<uint32_t> first(vertices + 1, 0);
    for (const auto& [from, to] : edges) ++first[from + 1];
    for (size_t v = 0; v < vertices; ++v) first[v + 1] += first[v];
    std::vector<uint32_t> next(first.begin(), first.end() - 1), to(edges.size());
    for (const auto& [a, b] : edges) to[next[a]++] = b;
    VertexGraph graph;
    graph.start.assign(vertices + 1, 0);
    graph.to.reserve(edges.size() / 2);
    for (size_t v = 0; v < vertices; ++v) {
        const auto begin = to.begin() + first[v], end = to.begin() + first[v + 1];
        std::sort(begin, end);
        graph.to.insert(graph.to.end(), begin, std::unique(begin, end));
        graph.start[v + 1] = uint32_t(graph.to.size());
    }
    return graph;
}

}  // namespace

VertexGraph buildVertexGraph(const Mesh& mesh, const Mat3& axes) {
    std::vector<std::pair<uint32_t, uint32_t>> edges;
    edges.reserve(mesh.triangles.size() * 6 + mesh.vertexCount() / 4);
    const auto join = [&](uint32_t a, uint32_t b) {
        if (a == b) return;
        edges.emplace_back(a, b);
        edges.emplace_back(b, a);
    };
    for (const Triangle& t : mesh.triangles)
        for (int k = 0; k < 3; ++k) join(t[k], t[(k + 1) % 3]);
    // Seams: vertices at the very same place belong together, about one that is chosen by where it faces, not by the
    // file's order.
    std::unordered_map<uint64_t, uint32_t> centreAt;
    centreAt.reserve(mesh.vertexCount());
    const auto keyOf = [&](uint32_t v) {
        uint32_t bits[3];
        std::memcpy(bits, &mesh.positions[v], sizeof bits);
        return mixBits(mixBits(mixBits(bits[0]) ^ bits[1]) ^ bits[2]);
    };
    const bool faces = mesh.normals.size() == mesh.vertexCount();
    const auto facing = [&](uint32_t v) {
        return faces ? glm::dot(mesh.normals[v] * axes, Vec3(0.5569f, 0.6831f, 0.4725f)) : 0.0f;
    };
    for (uint32_t v = 0; v < mesh.vertexCount(); ++v) {
        const auto [place, isNew] = centreAt.emplace(keyOf(v), v);
        if (!isNew && mesh.positions[place->second] == mesh.positions[v] && facing(v) < facing(place->second))
            place->second = v;
    }
    for (uint32_t v = 0; v < mesh.vertexCount(); ++v)
        if (const uint32_t centre = centreAt.at(keyOf(v)); mesh.positions[centre] == mesh.positions[v]) join(v, centre);
    return graphOf(edges, mesh.vertexCount());
}

std::vector<uint32_t> connectedComponents(const VertexGraph& graph, uint32_t* count) {
    const size_t n = graph.start.size() - 1;
    constexpr uint32_t none = ~0u;
    std::vector<uint32_t> component(n, none), stack;
    uint32_t components = 0;
    for (uint32_t seed = 0; seed < n; ++seed) {
        if (component[seed] != none) continue;
        stack.assign(1, seed);
        component[seed] = components;
        while (!stack.empty()) {
            const uint32_t v = stack.back();
            stack.pop_back();
            for (uint32_t e = graph.start[v]; e < graph.start[v + 1]; ++e)
                if (component[graph.to[e]] == none) {
                    component[graph.to[e]] = components;
                    stack.push_back(graph.to[e]);
                }
        }
        ++components;
    }
    if (count) *count = components;
    return component;
}

std::vector<Vec3> vertexNormalsFromFaces(const Mesh& mesh) {
    std::vector<Vec3> normals(mesh.vertexCount(), Vec3(0));
    for (const Triangle& t : mesh.triangles) {
        const Vec3 n =
            glm::cross(mesh.positions[t[1]] - mesh.positions[t[0]], mesh.positions[t[2]] - mesh.positions[t[0]]);
        for (uint32_t v : t) normals[v] += n;
    }
    for (Vec3& n : normals) {
        const float length = glm::length(n);
        n = length > 0 ? n / length : Vec3(0, 0, 1);
    }
    return normals;
}

}  // namespace relamp
