#include "clusters/emitter_pixels.h"

#include "base/parallel.h"

namespace relamp {
namespace {

/// Pixels that show an emitter (`in`) among all that hit a triangle or a vertex.
struct Votes {
    uint32_t in = 0, all = 0;
    void add(bool shows) {
        in += shows;
        ++all;
    }
    bool emits() const { return 2 * in > all; }
};

float distanceBetween(const Rgb& a, const Rgb& b) { return glm::length(a - b); }

/// Whether one of a pixel's eight neighbours is marked.
bool besideOne(const std::vector<uint8_t>& marked, int width, int height, int x, int y) {
    for (int py = std::max(0, y - 1); py <= std::min(height - 1, y + 1); ++py)
        for (int px = std::max(0, x - 1); px <= std::min(width - 1, x + 1); ++px)
            if (marked[size_t(py) * size_t(width) + size_t(px)]) return true;
    return false;
}

}  // namespace

float pixelTolerance(const EmitterCluster& cluster) { return std::max(0.08f, 3 * cluster.evidence.uniformity); }

std::vector<uint8_t> emittingPixels(const View& view, const Rgb& emitter, float tolerance) {
    const Image& image = view.image;
    const int width = image.width, height = image.height;
    std::vector<uint8_t> whole(size_t(width) * size_t(height), 0);
    const float reach = tolerance * glm::length(emitter);
    parallelFor(size_t(height), 32, [&](size_t y) {
        for (int x = 0; x < width; ++x)
            whole[y * size_t(width) + size_t(x)] =
                image.usableAt(x, int(y)) && distanceBetween(image.at(x, int(y)), emitter) < reach;
    });
    std::vector<uint8_t> result = whole;
    parallelFor(size_t(height), 32, [&](size_t row) {
        const int y = int(row);
        for (int x = 0; x < width; ++x) {
            const size_t pixel = row * size_t(width) + size_t(x);
            if (whole[pixel] || !image.usableAt(x, y) || !besideOne(whole, width, height, x, y)) continue;
            float farthest = 0;
            Rgb other(0);
            for (int dy = -1; dy <= 1; ++dy)
                for (int dx = -1; dx <= 1; ++dx) {
                    const int px = x + dx, py = y + dy;
                    if (px < 0 || py < 0 || px >= width || py >= height || !image.usableAt(px, py)) continue;
                    const Rgb value = image.at(px, py);
                    if (const float away = distanceBetween(value, emitter); away > farthest) {
                        farthest = away;
                        other = value;
                    }
                }
            const Rgb value = image.at(x, y);
            result[pixel] = distanceBetween(value, emitter) < distanceBetween(value, other);
        }
    });
    return result;
}

size_t growByPixels(const Scene& scene, const Capture& capture, const RadianceSamples& samples,
                    const std::vector<uint8_t>& taken, EmitterCluster& cluster) {
    constexpr uint32_t enough = 3;  // pixels that speak for a triangle by themselves
    std::vector<Votes> ofTriangle(scene.mesh.triangles.size()), ofVertex(scene.mesh.vertexCount());
    for (size_t i = 0; i < capture.views.size() && i < samples.geometry.size(); ++i) {
        const std::vector<uint8_t> shows = emittingPixels(capture.views[i], cluster.radiance, pixelTolerance(cluster));
        const std::vector<uint32_t>& hit = samples.geometry[i].triangle;
        for (size_t p = 0; p < hit.size() && p < shows.size(); ++p) {
            if (hit[p] == Hit::none) continue;
            ofTriangle[hit[p]].add(shows[p] != 0);
            for (const uint32_t v : scene.mesh.triangles[hit[p]]) ofVertex[v].add(shows[p] != 0);
        }
    }
    if (std::none_of(cluster.vertices.begin(), cluster.vertices.end(), [&](uint32_t v) { return ofVertex[v].in > 0; }))
        return 0;
    std::vector<uint8_t> mine(scene.mesh.vertexCount(), 0);
    for (const uint32_t v : cluster.vertices) mine[v] = 1;
    // From the vertices that it has to their neighbours that shine, and on.
    std::vector<uint32_t> front = cluster.vertices;
    while (!front.empty()) {
        std::vector<uint32_t> next;
        for (const uint32_t v : front)
            for (uint32_t e = scene.graph.start[v]; e < scene.graph.start[v + 1]; ++e) {
                const uint32_t u = scene.graph.to[e];
                if (mine[u] || taken[u] || !ofVertex[u].emits()) continue;
                mine[u] = 1;
                next.push_back(u);
            }
        front.swap(next);
    }
    // What is open at a corner goes by its own pixels. An emitter has the triangles all of whose corners are its own.
    std::vector<uint8_t> corner = mine;
    for (uint32_t t = 0; t < scene.mesh.triangles.size(); ++t) {
        const Triangle& corners = scene.mesh.triangles[t];
        const int shining = mine[corners[0]] + mine[corners[1]] + mine[corners[2]];
        const bool others =
            std::any_of(corners.begin(), corners.end(), [&](uint32_t v) { return taken[v] && !mine[v]; });
        if (shining == 0 || shining == 3 || others) continue;
        // One that no pixel falls on goes with what is around it.
        if (ofTriangle[t].all >= enough ? ofTriangle[t].emits() : shining == 2 && ofTriangle[t].all == 0)
            for (const uint32_t v : corners) corner[v] = 1;
    }
    const size_t before = cluster.triangles.size();
    cluster.triangles.clear();
    for (uint32_t t = 0; t < scene.mesh.triangles.size(); ++t) {
        const Triangle& corners = scene.mesh.triangles[t];
        if (corner[corners[0]] && corner[corners[1]] && corner[corners[2]]) cluster.triangles.push_back(t);
    }
    cluster.vertices.clear();
    for (uint32_t v = 0; v < corner.size(); ++v)
        if (corner[v]) cluster.vertices.push_back(v);
    return cluster.triangles.size() - before;
}

}  // namespace relamp
