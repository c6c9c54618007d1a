#include "scene/flat_surface.h"

#include <algorithm>
#include <numeric>
#include <optional>

#include "base/statistics.h"

namespace relamp {
namespace {

constexpr size_t seeds = 200, mostSurfaces = 4;
constexpr float planeTolerance = 0.004f;  ///< of the diagonal
constexpr double alongNormal = 0.9;       ///< cosine between normals of mesh and plane
constexpr double leastArea = 0.05;        ///< of the mesh
constexpr double standsOut = 3;           ///< standard deviations of what a surface's vertices are off by
constexpr double mostBent = 0.6;          ///< of the squares of heights
constexpr int followers = 4;              ///< rings of edges
constexpr float following = 0.75f;        ///< of the ring before

std::vector<uint32_t> byRank(const Scene& scene) {
    std::vector<uint32_t> order;
    for (uint32_t v = 0; v < scene.mesh.vertexCount(); ++v)
        if (scene.referenced[v]) order.push_back(v);
    std::sort(order.begin(), order.end(),
              [&](uint32_t a, uint32_t b) { return std::pair(scene.rank[a], a) < std::pair(scene.rank[b], b); });
    return order;
}

double areaAt(const Scene& scene, uint32_t v) {
    return double(scene.vertexSpacing[v]) * double(scene.vertexSpacing[v]);
}

/// The least squares plane of the vertices on one: heights tell its tilt to a fraction of what normals do.
FlatSurface fitted(const Scene& scene, const FlatSurface& plane, const std::vector<uint32_t>& vertices) {
    const glm::dmat3 axes(frameAround(Vec3(plane.up)));
    const DVec3 up = plane.up, x = axes[0], y = glm::cross(up, x);
    glm::dmat3 a(0);
    DVec3 b(0);
    double area = 0;
    for (const uint32_t v : vertices) {
        if (!liesOn(scene, plane, v)) continue;
        const DVec3 p = DVec3(scene.mesh.positions[v]) - plane.point, terms(1, glm::dot(p, x), glm::dot(p, y));
        a += areaAt(scene, v) * glm::outerProduct(terms, terms);
        b += areaAt(scene, v) * glm::dot(p, up) * terms;
        area += areaAt(scene, v);
    }
    const DVec3 c = glm::inverse(a) * b;
    if (!isFinite(Vec3(c))) return plane;
    return {plane.point + c.x * up, glm::normalize(up - c.y * x - c.z * y), area};
}

/// Planes with a large part of the area of `left`, whose vertices they take.
std::optional<FlatSurface> largestPlane(const Scene& scene, std::vector<uint32_t>& left, double total) {
    FlatSurface best;
    for (size_t i = 0; i < std::min(seeds, left.size()); ++i) {
        FlatSurface plane{DVec3(scene.mesh.positions[left[i]]), DVec3(scene.mesh.normals[left[i]]), 0};
        for (const uint32_t v : left)
            if (liesOn(scene, plane, v)) plane.area += areaAt(scene, v);
        if (plane.area > best.area) best = plane;
    }
    for (int refinement = 0; refinement < 4 && best.area > 0; ++refinement) best = fitted(scene, best, left);
    std::erase_if(left, [&](uint32_t v) { return liesOn(scene, best, v); });
    if (!(best.area > leastArea * total)) return {};
    return best;
}

/// What part of the squares of heights over the plane a surface of second order explains: much of a cylinder's or a
/// ball's, little of waves.
double bentPart(const Scene& scene, const FlatSurface& plane, const std::vector<uint32_t>& vertices) {
    const glm::dmat3 axes(frameAround(Vec3(plane.up)));
    std::vector<std::vector<double>> terms(7, std::vector<double>(vertices.size()));
    for (size_t i = 0; i < vertices.size(); ++i) {
        const DVec3 at = DVec3(scene.mesh.positions[vertices[i]]) - plane.point;
        const double x = glm::dot(at, axes[0]) / double(scene.diagonal),
                     y = glm::dot(at, axes[1]) / double(scene.diagonal);
        const double values[] = {1, x, y, x * x, x * y, y * y, plane.off(DVec3(scene.mesh.positions[vertices[i]]))};
        for (size_t k = 0; k < terms.size(); ++k) terms[k][i] = values[k];
    }
    // Gram and Schmidt: the heights come last.
    const auto product = [&](size_t a, size_t b) {
        return std::inner_product(terms[a].begin(), terms[a].end(), terms[b].begin(), 0.0);
    };
    double explained = 0, all = 0;
    for (size_t k = 0; k < terms.size(); ++k)
        for (size_t j = 0; j < k; ++j) {
            const double length = product(j, j), along = product(k, j);
            if (k == 6 && j == 3) all = product(k, k);
            if (!(length > 0)) continue;
            if (k == 6 && j >= 3) explained += along * along / length;
            for (size_t i = 0; i < vertices.size(); ++i) terms[k][i] -= along / length * terms[j][i];
        }
    return all > 0 ? explained / all : 0;
}

}  // namespace

bool liesOn(const Scene& scene, const FlatSurface& surface, uint32_t vertex) {
    return std::abs(surface.off(DVec3(scene.mesh.positions[vertex]))) < double(planeTolerance * scene.diagonal) &&
           glm::dot(DVec3(scene.mesh.normals[vertex]), surface.up) > alongNormal;
}

std::vector<FlatSurface> flatSurfaces(const Scene& scene, const std::vector<uint8_t>& leftOut) {
    std::vector<uint32_t> left = byRank(scene);
    double total = 0;
    for (const uint32_t v : left) total += areaAt(scene, v);
    std::erase_if(left, [&](uint32_t v) { return leftOut[v] != 0; });
    std::vector<FlatSurface> result;
    while (result.size() < mostSurfaces) {
        const std::optional<FlatSurface> next = largestPlane(scene, left, total);
        if (!next) break;
        result.push_back(*next);
    }
    return result;
}

bool Flattening::isFlat(size_t of) const { return bent[of] <= mostBent; }

Flattening flattening(const Scene& scene, const std::vector<FlatSurface>& surfaces, size_t vertices,
                      const std::vector<uint8_t>& leftOut) {
    Flattening result;
    result.move.assign(vertices, 0);
    result.surface.assign(vertices, -1);
    std::vector<uint8_t> moves(vertices, 0);
    std::vector<uint32_t> ring;
    for (size_t s = 0; s < surfaces.size(); ++s) {
        std::vector<uint32_t> on;
        std::vector<float> off;
        for (uint32_t v = 0; v < vertices; ++v) {
            if (leftOut[v] || moves[v] || !scene.referenced[v] || !liesOn(scene, surfaces[s], v)) continue;
            on.push_back(v);
            off.push_back(float(std::abs(surfaces[s].off(DVec3(scene.mesh.positions[v])))));
        }
        const double waves = on.empty() ? 0 : 1.4826 * double(medianOf(std::move(off)));
        result.waves.push_back(waves);
        result.bent.push_back(bentPart(scene, surfaces[s], on));
        if (!result.isFlat(s)) continue;
        for (const uint32_t v : on) {
            const double height = surfaces[s].off(DVec3(scene.mesh.positions[v]));
            if (std::abs(height) > standsOut * waves) continue;
            result.move[v] = float(-height / glm::dot(DVec3(scene.mesh.normals[v]), surfaces[s].up));
            result.surface[v] = int(s);
            moves[v] = 1;
            ring.push_back(v);
        }
    }
    for (int k = 0; k < followers; ++k) {
        std::vector<uint32_t> next;
        for (const uint32_t from : ring)
            for (uint32_t e = scene.graph.start[from]; e < scene.graph.start[from + 1]; ++e)
                if (const uint32_t v = scene.graph.to[e]; v < vertices && !moves[v] && !leftOut[v]) {
                    moves[v] = 2;
                    next.push_back(v);
                }
        std::sort(next.begin(), next.end());
        for (const uint32_t v : next) {
            float sum = 0, count = 0;
            for (uint32_t e = scene.graph.start[v]; e < scene.graph.start[v + 1]; ++e)
                if (const uint32_t n = scene.graph.to[e]; n < vertices && moves[n] == 1) {
                    sum += result.move[n];
                    count += 1;
                }
            if (count > 0) result.move[v] = following * sum / count;
        }
        for (const uint32_t v : next) moves[v] = 1;
        ring = std::move(next);
    }
    return result;
}

}  // namespace relamp
