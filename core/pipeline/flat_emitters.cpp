#include "pipeline/flat_emitters.h"

#include <algorithm>
#include <cmath>

#include "base/log.h"
#include "base/statistics.h"
#include "clusters/emitter_sphere.h"
#include "scene/vertex_rings.h"
#include "solve/registration/flat_outline.h"

namespace relamp {
namespace {

constexpr float alongNormal = 0.95f;       ///< cosine of a front's normals with their mean
constexpr float flatness = 0.03f;          ///< of the front's side: what its vertices may be off a plane (median)
constexpr float likeNormal = 0.8f;         ///< cosine of the surface behind
constexpr float mostlyFlat = 0.5f;         ///< of an emitter's vertices, and of those around it
constexpr int ringsFrom = 3, ringsTo = 6;  ///< of neighbours that tell where the surface behind lies
constexpr float frontFrom = 0.7f;          ///< of its height: from there on a rounded front is its plane
constexpr double mostResidual = 1;         ///< pixels
constexpr double surest = 0.3;             ///< of the height: deviation up to which outlines are believed
constexpr float rimBand = 0.75f;           ///< of an edge: what lies so close to the outline is on it
constexpr float mostShift = 0.01f;         ///< of the diagonal

/// A flat front, and the surface behind it.
struct Front {
    Vec3 normal{0};
    float depth = 0, base = 0;  ///< metres along the normal, from the emitter's centroid
};

std::optional<Front> frontOf(const Scene& scene, const EmitterCluster& e) {
    Front front;
    front.normal = e.normal;
    std::vector<float> depths;
    // Sides turn the mean normal: it is that of the vertices which are near it.
    for (int round = 0; round < 3; ++round) {
        Vec3 sum(0);
        depths.clear();
        for (const uint32_t v : e.vertices) {
            if (glm::dot(scene.mesh.normals[v], front.normal) < (round ? alongNormal : likeNormal)) continue;
            sum += scene.mesh.normals[v];
            depths.push_back(glm::dot(scene.mesh.positions[v] - e.centroid, front.normal));
        }
        if (float(depths.size()) < mostlyFlat * float(e.vertices.size())) return {};
        front.normal = glm::normalize(sum);
    }
    const float side = std::sqrt(e.area);
    front.depth = medianOf(depths);
    for (float& d : depths) d = std::abs(d - front.depth);
    if (medianOf(depths) > flatness * side) return {};
    // The surface behind, a few rings of neighbours outside.
    std::vector<uint32_t> reached = e.vertices;
    const std::vector<int> rings = ringsAbout(scene.graph, ringsTo, reached);
    std::vector<float> behind;
    size_t around = 0;
    for (const uint32_t v : reached) {
        if (rings[v] < ringsFrom) continue;
        ++around;
        if (glm::dot(scene.mesh.normals[v], front.normal) > likeNormal)
            behind.push_back(glm::dot(scene.mesh.positions[v] - e.centroid, front.normal));
    }
    if (behind.empty() || float(behind.size()) < mostlyFlat * float(around)) return {};
    front.base = medianOf(behind);
    return front;
}

float medianEdge(const Scene& scene, const EmitterCluster& e) {
    std::vector<float> lengths;
    for (const uint32_t t : e.triangles)
        for (size_t k = 0; k < 3; ++k) {
            const Triangle& at = scene.mesh.triangles[t];
            lengths.push_back(glm::distance(scene.mesh.positions[at[k]], scene.mesh.positions[at[(k + 1) % 3]]));
        }
    return medianOf(std::move(lengths));
}

}  // namespace

std::vector<EmitterMove> liftedFronts(const Scene& scene, const Capture& capture, const RadianceSamples& samples,
                                      const EmitterClusters& clusters) {
    std::vector<EmitterMove> moves;
    for (const EmitterCluster& e : clusters.emitters) {
        if (e.unobserved || e.fitted || e.twoSided || e.triangles.empty()) continue;
        const std::optional<Front> front = frontOf(scene, e);
        if (!front || !(front->depth > front->base)) continue;
        const std::vector<EmitterOutline> outlines = emitterOutlines(scene, capture, samples, clusters, e);
        const std::optional<FlatOutline> fit =
            fitFlatOutline(capture, outlines, DVec3(e.centroid + front->depth * front->normal), DVec3(front->normal));
        if (!fit) continue;
        logInfo(
            "outlines of a flat light at {:.2f} {:.2f} {:.2f}, {:.1f} cm before what is behind it, put its front "
            "{:.1f} +- {:.1f} mm farther out and its back {:.1f}; {:.2f} pixels, {} views",
            e.centroid.x + capture.origin.x, e.centroid.y + capture.origin.y, e.centroid.z + capture.origin.z,
            100 * (front->depth - front->base), 1000 * fit->front, 1000 * fit->deviation, 1000 * fit->back,
            fit->residual, fit->views);
        const float height = front->depth - front->base, newHeight = height + float(fit->front);
        if (fit->residual > mostResidual || !(newHeight > 0) || fit->deviation > surest * double(newHeight) ||
            std::abs(fit->front) > double(mostShift * scene.diagonal))
            continue;
        EmitterMove move;
        move.centroid = e.centroid;
        move.overlap = meshOverlap(samples, e, outlines);
        const float edge = medianEdge(scene, e);
        for (const uint32_t v : e.vertices) {
            const Vec3 from = scene.mesh.positions[v] - e.centroid;
            const float at = glm::dot(from, front->normal) - front->base,
                        part = std::min(1.0f, at / (frontFrom * height));
            if (!(part > 0)) continue;
            const double x = glm::dot(DVec3(from), fit->first), y = glm::dot(DVec3(from), fit->second),
                         reach = std::hypot(x, y), rim = fit->edgeTowards(x, y);
            Vec3 to = scene.mesh.positions[v] + (part * newHeight - at) * front->normal;
            // The rim is as sharp as photographs show it.
            if (part < 1 || reach > rim - double(rimBand * edge))
                to += Vec3((rim / std::max(reach, 1e-30) - 1) * (x * fit->first + y * fit->second));
            if (glm::distance(to, scene.mesh.positions[v]) > 2 * std::max(edge, std::abs(newHeight - height))) continue;
            move.vertices.push_back({v, to});
            move.shining.push_back(v);
            move.radius = std::max(move.radius, glm::length(from));
        }
        move.words = fmt::format(
            "outlines of a flat light at {:.2f} {:.2f} {:.2f} meet {:.1f} mm {} the mesh: its front goes there, its "
            "rim to them",
            e.centroid.x + capture.origin.x, e.centroid.y + capture.origin.y, e.centroid.z + capture.origin.z,
            1000 * std::abs(fit->front), fit->front > 0 ? "before" : "behind");
        moves.push_back(std::move(move));
    }
    return moves;
}

void liftFronts(const Scene& scene, const Capture& capture, const RadianceSamples& samples,
                const EmitterClusters& clusters, EmitterMend& found) {
    for (EmitterMove& m : liftedFronts(scene, capture, samples, clusters)) {
        const bool replaced = std::any_of(found.bodies.begin(), found.bodies.end(), [&](const auto& r) {
            return r.body.distance(DVec3(m.centroid)) < double(r.was.radius) / 4;
        });
        if (replaced) continue;
        std::erase_if(found.moves, [&](const EmitterMove& other) { return other.centroid == m.centroid; });
        found.moves.push_back(std::move(m));
    }
}

}  // namespace relamp
