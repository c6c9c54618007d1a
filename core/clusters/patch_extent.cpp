#include "clusters/patch_extent.h"

#include <algorithm>

#include "base/parallel.h"
#include "base/statistics.h"

namespace relamp {
namespace {

constexpr double darkestPart = 0.05;    ///< of an emitter's vertices: they may shine unevenly
constexpr float shinesAtLeast = 0.25f;  ///< of the radiance of these
constexpr int mixedPixels = 3;          ///< about an outline, that may mix what lies on both sides
constexpr float visibleWithin = 0.005f;

/// The brightest that a view shows of a vertex and of the pixels about it; below 0: it does not show its front.
float glimpse(const Mesh& mesh, size_t vertex, const View& view, const ViewGeometry& geometry) {
    const Vec3 point = mesh.positions[vertex], toEye = Vec3(view.camera.position()) - point;
    if (!(glm::dot(mesh.normals[vertex], toEye) > 0)) return -1;
    const std::optional<Vec2> at = view.camera.project(DVec3(point));
    if (!at || !(at->x >= 0) || !(at->y >= 0) || !(at->x < float(geometry.width)) || !(at->y < float(geometry.height)))
        return -1;
    const int x = int(at->x), y = int(at->y);
    const float distance = glm::length(toEye);
    if (!(std::abs(geometry.depth[size_t(y) * size_t(geometry.width) + size_t(x)] - distance) <
          visibleWithin * distance))
        return -1;
    float brightest = -1;
    for (int j = std::max(0, y - mixedPixels); j <= std::min(geometry.height - 1, y + mixedPixels); ++j)
        for (int i = std::max(0, x - mixedPixels); i <= std::min(geometry.width - 1, x + mixedPixels); ++i)
            if (view.image.usableAt(i, j)) brightest = std::max(brightest, maxChannel(view.image.at(i, j)));
    return brightest;
}

/// Some vertices and the box around them.
struct PatchPart {
    std::vector<uint32_t> vertices;
    Vec3 low{1e30f}, high{-1e30f};

    void add(const Scene& scene, uint32_t v) {
        vertices.push_back(v);
        low = glm::min(low, scene.mesh.positions[v]);
        high = glm::max(high, scene.mesh.positions[v]);
    }
    void add(const PatchPart& other) {
        vertices.insert(vertices.end(), other.vertices.begin(), other.vertices.end());
        low = glm::min(low, other.low);
        high = glm::max(high, other.high);
    }
    /// Whether no more lies between both boxes than half the larger one's diagonal.
    bool beside(const PatchPart& other) const {
        const Vec3 gap = glm::max(glm::max(low - other.high, other.low - high), Vec3(0));
        return glm::length(gap) <= 0.5f * std::max(glm::distance(low, high), glm::distance(other.low, other.high));
    }
};

/// Connected parts of some vertices.
std::vector<PatchPart> connectedParts(const Scene& scene, const std::vector<uint32_t>& vertices) {
    std::vector<uint8_t> open(scene.mesh.vertexCount(), 0);
    for (const uint32_t v : vertices) open[v] = 1;
    std::vector<PatchPart> parts;
    for (const uint32_t seed : vertices) {
        if (!open[seed]) continue;
        open[seed] = 0;
        PatchPart& part = parts.emplace_back();
        part.add(scene, seed);
        for (size_t i = 0; i < part.vertices.size(); ++i)
            for (uint32_t e = scene.graph.start[part.vertices[i]]; e < scene.graph.start[part.vertices[i] + 1]; ++e) {
                const uint32_t u = scene.graph.to[e];
                if (!open[u]) continue;
                open[u] = 0;
                part.add(scene, u);
            }
    }
    return parts;
}

}  // namespace

std::vector<std::vector<uint32_t>> partsApart(const Scene& scene, const std::vector<uint32_t>& vertices) {
    std::vector<PatchPart> parts = connectedParts(scene, vertices);
    for (size_t i = 0; i < parts.size(); ++i)
        for (size_t k = i + 1; k < parts.size();) {
            if (!parts[i].beside(parts[k])) {
                ++k;
                continue;
            }
            parts[i].add(parts[k]);
            parts.erase(parts.begin() + ptrdiff_t(k));
            k = i + 1;  // what is larger now may reach others
        }
    std::vector<std::vector<uint32_t>> result;
    for (PatchPart& part : parts) {
        std::sort(part.vertices.begin(), part.vertices.end());
        result.push_back(std::move(part.vertices));
    }
    return result;
}

std::vector<float> glimpsesOf(const Scene& scene, const Capture& capture, const RadianceSamples& samples,
                              const std::vector<VertexRadiance>& seen) {
    std::vector<float> result(seen.size(), -1);
    parallelFor(seen.size(), 256, [&](size_t v) {
        if (seen[v].weight > 0 || !scene.referenced[v]) return;
        std::vector<float> shown;
        for (size_t i = 0; i < capture.views.size(); ++i)
            if (const float brightest = glimpse(scene.mesh, v, capture.views[i], samples.geometry[i]); brightest >= 0)
                shown.push_back(brightest);
        if (shown.size() > 1) result[v] = medianOf(std::move(shown));
    });
    return result;
}

void complete(const Scene& scene, const std::vector<VertexRadiance>& seen, const std::vector<float>& glimpses,
              const std::vector<uint8_t>& ofOthers, EmitterCluster& cluster) {
    std::vector<uint8_t> mine(seen.size(), 0);
    std::vector<float> levels;
    for (const uint32_t v : cluster.vertices)
        if (seen[v].weight > 0) levels.push_back(maxChannel(seen[v].radiance));
    const float least = shinesAtLeast * quantileOf(std::move(levels), darkestPart);
    const auto shines = [&](uint32_t v) { return glimpses[v] < 0 || glimpses[v] > least; };
    for (uint32_t v : cluster.vertices) mine[v] = 1;
    // A connected component whose clearly seen vertices nearly all shine is an emitter as a whole.
    std::vector<float> shining(scene.components, 0), clear(scene.components, 0);
    for (uint32_t v = 0; v < seen.size(); ++v) {
        if (seen[v].weight <= 0) continue;
        clear[scene.component[v]] += seen[v].weight;
        if (mine[v]) shining[scene.component[v]] += seen[v].weight;
    }
    for (uint32_t v = 0; v < seen.size(); ++v) {
        const uint32_t p = scene.component[v];
        if (!mine[v] && !ofOthers[v] && shining[p] > 0.7f * clear[p] && shines(v)) mine[v] = 1;
    }
    // Elsewhere unobserved neighbours of similar orientation join, a few rings far.
    std::vector<uint32_t> ring = cluster.vertices;
    for (int step = 0; step < 3; ++step) {
        std::vector<uint32_t> next;
        for (uint32_t v : ring)
            for (uint32_t e = scene.graph.start[v]; e < scene.graph.start[v + 1]; ++e) {
                const uint32_t u = scene.graph.to[e];
                if (mine[u] || ofOthers[u] || seen[u].weight > 0 || !shines(u) ||
                    glm::dot(scene.mesh.normals[u], scene.mesh.normals[v]) < 0.5f)
                    continue;
                mine[u] = 1;
                next.push_back(u);
            }
        ring.swap(next);
    }
    cluster.vertices.clear();
    for (uint32_t v = 0; v < mine.size(); ++v)
        if (mine[v]) cluster.vertices.push_back(v);
}

}  // namespace relamp
