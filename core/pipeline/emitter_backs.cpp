#include "pipeline/emitter_backs.h"

#include <algorithm>

#include "base/log.h"
#include "base/parallel.h"
#include "pipeline/plan_pilot.h"

namespace relamp {
namespace {

constexpr float mostlyOpen = 0.5f;  ///< of the area
constexpr double leastFall = 0.01;  ///< of the misfit
constexpr double leastErrors = 3;   ///< standard errors

/// With `candidate` taken for an emitter.
EmitterClusters withCandidate(const Scene& scene, const EmitterClusters& clusters, const EmitterCluster& candidate) {
    EmitterClusters all = clusters;
    all.emitters.push_back(candidate);
    indexEmitters(scene, all);
    return all;
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
    std::vector<uint8_t> skip(scene.mesh.vertexCount(), 0);
    for (const std::vector<EmitterCluster>* list : {&clusters.emitters, &clusters.candidates})
        for (const EmitterCluster& e : *list)
            for (const uint32_t v : e.vertices) skip[v] = 1;
    const RatioObservations observed = ratioObservations(scene, samples, std::move(skip), options.seed);
    if (observed.pairs.size() < 1000) return result;
    EmitterClusters present = clusters;
    for (const EmitterCluster* e : asked) {
        const bool certain = std::any_of(present.emitters.begin(), present.emitters.end(),
                                         [&](const EmitterCluster& other) { return other.vertices == e->vertices; });
        const EmitterClusters oneSided = certain ? present : withCandidate(scene, present, *e);
        EmitterClusters twoSided = oneSided;
        for (EmitterCluster& other : twoSided.emitters) other.twoSided |= other.vertices == e->vertices;
        const auto misfits = [&](const EmitterClusters& emitters) {
            return pilotMisfits(scene, samples, emitters, observed.matte, observed.pairs, options, progress);
        };
        const MisfitFall fall = misfitFall(misfits(oneSided), misfits(twoSided));
        logInfo("a light of {:.0f} cm2 that is a sheet, if it shines to both sides: {}", 1e4f * e->area, fall.words());
        if (!fall.exceeds(leastFall, leastErrors)) continue;
        result.insert(result.end(), e->vertices.begin(), e->vertices.end());
        if (certain) present = twoSided;
    }
    std::sort(result.begin(), result.end());
    return result;
}

}  // namespace relamp
