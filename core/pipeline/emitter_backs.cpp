#include "pipeline/emitter_backs.h"

#include <algorithm>
#include <functional>

#include "base/log.h"
#include "base/parallel.h"
#include "base/sort_unique.h"
#include "clusters/shining_sides.h"
#include "pipeline/mend_mesh.h"
#include "pipeline/plan_pilot.h"

namespace relamp {
namespace {

constexpr float mostlyOpen = 0.5f;       ///< of the area
constexpr double leastFall = 0.01;       ///< of the misfit
constexpr double leastErrors = 3;        ///< standard errors
constexpr double leastSkinFall = 0.002;  ///< of the misfit: what closes a light shines more often than not
constexpr double leastSkinErrors = 4;    ///< standard errors
constexpr float leastSkin = 0.05f;       ///< of an emitter's area
constexpr float skinReach = 1.1f;        ///< of the radius about its box

/// With `candidate` taken for an emitter.
EmitterClusters withCandidate(const Scene& scene, const EmitterClusters& clusters, const EmitterCluster& candidate) {
    EmitterClusters all = clusters;
    all.emitters.push_back(candidate);
    indexEmitters(scene, all);
    return all;
}

using Misfits = std::function<std::vector<double>(const EmitterClusters&)>;

/// The pilot's misfits under any emitters, from pairs that none of `clusters` and none of `besides` touches; null: too
/// few pairs.
Misfits misfitsOf(const Scene& scene, const RadianceSamples& samples, const EmitterClusters& clusters,
                  const std::vector<uint32_t>& besides, const SolveOptions& options, Progress& progress) {
    std::vector<uint8_t> skip = verticesOf(scene, {&clusters.emitters, &clusters.candidates});
    for (const uint32_t v : besides) skip[v] = 1;
    const auto observed =
        std::make_shared<const RatioObservations>(ratioObservations(scene, samples, std::move(skip), options.seed));
    if (observed->pairs.size() < 1000) return {};
    return [=, &scene, &samples, &options, &progress](const EmitterClusters& emitters) {
        return pilotMisfits(scene, samples, emitters, observed->matte, observed->pairs, options, progress);
    };
}

/// Vertices that at most one view sees, connected with the emitter by others of them, within its reach.
std::vector<uint32_t> skinOf(const Scene& scene, const RadianceSamples& samples, const EmitterClusters& clusters,
                             const EmitterCluster& emitter) {
    Vec3 low(1e30f), high(-1e30f);
    for (const uint32_t v : emitter.vertices)
        low = glm::min(low, scene.mesh.positions[v]), high = glm::max(high, scene.mesh.positions[v]);
    const Vec3 middle = 0.5f * (low + high);
    const float reach = skinReach * 0.5f * glm::length(high - low);
    std::vector<uint8_t> reached = verticesOf(scene, {&clusters.emitters, &clusters.candidates});
    std::vector<uint32_t> skin, front = emitter.vertices;
    while (!front.empty()) {
        const uint32_t v = front.back();
        front.pop_back();
        for (uint32_t k = scene.graph.start[v]; k < scene.graph.start[v + 1]; ++k) {
            const uint32_t u = scene.graph.to[k];
            if (reached[u] || samples.countOf(u) > 1 || glm::distance(scene.mesh.positions[u], middle) > reach)
                continue;
            reached[u] = 1;
            skin.push_back(u);
            front.push_back(u);
        }
    }
    std::sort(skin.begin(), skin.end());
    return skin;
}

}  // namespace

float openBehind(const Scene& scene, const EmitterCluster& emitter) {
    std::vector<float> area(emitter.triangles.size(), 0), open = area;
    parallelFor(emitter.triangles.size(), 64, [&](size_t i) {
        const uint32_t t = emitter.triangles[i];
        const Triangle& at = scene.mesh.triangles[t];
        const Vec3 normal = scene.mesh.faceNormal(t);
        const Vec3 centre =
            (scene.mesh.positions[at[0]] + scene.mesh.positions[at[1]] + scene.mesh.positions[at[2]]) / 3.0f;
        const Hit hit = scene.tracer->closest({centre, -normal, scene.tracer->surfaceOffset(), 1e30f});
        area[i] = scene.mesh.triangleArea(t);
        if (!hit || glm::dot(scene.mesh.faceNormal(hit.triangle), normal) > 0) open[i] = area[i];
    });
    float all = 0, behind = 0;
    for (size_t i = 0; i < area.size(); ++i) all += area[i], behind += open[i];
    return all > 0 ? behind / all : 0;
}

std::vector<uint32_t> shiningToBothSides(const Scene& scene, const RadianceSamples& samples,
                                         const EmitterClusters& clusters, const SolveOptions& options,
                                         Progress& progress) {
    std::vector<uint32_t> result;
    std::vector<const EmitterCluster*> asked;
    for (const std::vector<EmitterCluster>* list : {&clusters.emitters, &clusters.candidates})
        for (const EmitterCluster& e : *list)
            if (!e.fitted && !e.unobserved && !e.twoSided && openBehind(scene, e) > mostlyOpen) asked.push_back(&e);
    if (asked.empty()) return result;
    const Misfits misfits = misfitsOf(scene, samples, clusters, {}, options, progress);
    if (!misfits) return result;
    EmitterClusters present = clusters;
    for (const EmitterCluster* e : asked) {
        const bool certain = std::any_of(present.emitters.begin(), present.emitters.end(),
                                         [&](const EmitterCluster& other) { return other.vertices == e->vertices; });
        const EmitterClusters oneSided = certain ? present : withCandidate(scene, present, *e);
        EmitterClusters twoSided = oneSided;
        for (EmitterCluster& other : twoSided.emitters) other.twoSided |= other.vertices == e->vertices;
        const MisfitFall fall = misfitFall(misfits(oneSided), misfits(twoSided));
        logInfo("a light of {:.0f} cm2 that is a sheet, if it shines to both sides: {}", 1e4f * e->area, fall.words());
        if (!fall.exceeds(leastFall, leastErrors)) continue;
        result.insert(result.end(), e->vertices.begin(), e->vertices.end());
        if (certain) present = twoSided;
    }
    std::sort(result.begin(), result.end());
    return result;
}

std::vector<uint32_t> shiningSkins(const Scene& scene, const RadianceSamples& samples, const EmitterClusters& clusters,
                                   const SolveOptions& options, Progress& progress) {
    std::vector<uint32_t> result;
    for (const std::vector<EmitterCluster>* list : {&clusters.emitters, &clusters.candidates})
        for (const EmitterCluster& e : *list) {
            if (e.fitted || e.unobserved) continue;
            const std::vector<uint32_t> skin = skinOf(scene, samples, clusters, e);
            if (skin.empty()) continue;
            const EmitterClusters bare = list == &clusters.emitters ? clusters : withCandidate(scene, clusters, e);
            EmitterClusters closed = bare;
            letSidesShine(scene, skin, closed);
            const auto areaOf = [&](const EmitterClusters& all) {
                double area = 0;
                for (const EmitterCluster& other : all.emitters) area += double(other.area);
                return area;
            };
            const double more = areaOf(closed) - areaOf(bare);
            if (more < double(leastSkin * e.area)) continue;
            const Misfits misfits = misfitsOf(scene, samples, clusters, skin, options, progress);
            if (!misfits) continue;
            const MisfitFall fall = misfitFall(misfits(bare), misfits(closed));
            logInfo("a light of {:.0f} cm2, if {:.0f} cm2 that close it shine too: {}", 1e4f * e.area, 1e4 * more,
                    fall.words());
            if (fall.exceeds(leastSkinFall, leastSkinErrors)) result.insert(result.end(), skin.begin(), skin.end());
        }
    sortUnique(result);
    return result;
}

}  // namespace relamp
