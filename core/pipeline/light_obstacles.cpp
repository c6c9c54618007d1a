#include "pipeline/light_obstacles.h"

#include "base/log.h"
#include "base/sort_unique.h"
#include "pipeline/plan_pilot.h"
#include "radiance/agreement.h"

namespace relamp {

std::vector<std::vector<uint32_t>> obstacleSuspects(const Scene& scene, const RadianceSamples& samples,
                                                    const EmitterClusters& emitters, size_t given) {
    std::vector<std::vector<uint32_t>> suspects;
    for (const RejectedPatch& patch : emitters.rejected) {
        std::vector<uint32_t> beside = patch.besideBall;
        std::erase_if(beside, [&](uint32_t v) { return v >= given; });
        if (!beside.empty()) suspects.push_back(std::move(beside));
    }
    for (const EmitterCluster& e : emitters.emitters) {
        if (!e.fitted) continue;
        const float radius = std::sqrt(e.area / (4 * pi));
        // A surface beside a light shows less than half of it, the light's own remains more.
        const auto shines = [&](uint32_t v) {
            const std::optional<Rgb> seen = medianObservation(samples, v);
            return seen && luminance(*seen) > 0.5f * luminance(e.radiance);
        };
        const auto within = [&](float reach, bool shiningToo) {
            std::vector<uint32_t> found;
            for (uint32_t v = 0; v < std::min(given, scene.mesh.vertexCount()); ++v)
                if (scene.referenced[v] && (samples.countOf(v) == 0 || (shiningToo && shines(v))) &&
                    emitters.emitterOfVertex[v] < 0 &&
                    glm::length(scene.mesh.positions[v] - e.centroid) < reach * radius)
                    found.push_back(v);
            if (!found.empty()) suspects.push_back(std::move(found));
        };
        within(3, false);
        within(6, false);
        within(1.5f, true);  // what the reconstruction made of the ball itself
    }
    return suspects;
}

Scene withoutShadowOf(const Scene& scene, const std::vector<uint32_t>& triangles) {
    Scene open = scene;
    open.mesh.shadowless.insert(open.mesh.shadowless.end(), triangles.begin(), triangles.end());
    sortUnique(open.mesh.shadowless);
    open.tracer = std::make_shared<const RayTracer>(open.mesh, open.diagonal);
    return open;
}

std::vector<uint32_t> falseObstacles(const Scene& scene, const RadianceSamples& samples,
                                     const EmitterClusters& emitters,
                                     const std::vector<std::vector<uint32_t>>& suspects, const SolveOptions& options,
                                     Progress& progress) {
    std::vector<uint32_t> result;
    if (suspects.empty()) return result;
    // None of the suspects tells of the light, with or without them.
    std::vector<uint8_t> skip(scene.mesh.vertexCount(), 0);
    for (size_t v = 0; v < skip.size(); ++v) skip[v] = emitters.emitterOfVertex[v] >= 0;
    for (const std::vector<uint32_t>& vertices : suspects)
        for (const uint32_t v : vertices) skip[v] = 1;
    const RatioObservations observed = ratioObservations(scene, samples, std::move(skip), options.seed);
    if (observed.pairs.size() < 1000) return result;
    std::vector<double> present =
        pilotMisfits(scene, samples, emitters, observed.matte, observed.pairs, options, progress);
    // Two skins, one behind the other, show only when one of them is gone: those that stayed are asked once more.
    for (size_t k = 0, sinceAccepted = 0; k < 2 * suspects.size() && sinceAccepted < suspects.size(); ++k) {
        const std::vector<uint32_t>& vertices = suspects[k % suspects.size()];
        ++sinceAccepted;
        std::vector<uint8_t> suspect(scene.mesh.vertexCount(), 0);
        for (const uint32_t v : vertices) suspect[v] = 1;
        std::vector<uint32_t> triangles = result;
        for (uint32_t t = 0; t < scene.mesh.triangles.size(); ++t) {
            const Triangle& corners = scene.mesh.triangles[t];
            if (emitters.emitterOfTriangle[t] < 0 &&
                (suspect[corners[0]] || suspect[corners[1]] || suspect[corners[2]]))
                triangles.push_back(t);
        }
        sortUnique(triangles);
        if (triangles.size() == result.size()) continue;
        const std::vector<double> misfits = pilotMisfits(withoutShadowOf(scene, triangles), samples, emitters,
                                                         observed.matte, observed.pairs, options, progress);
        const MisfitFall fall = misfitFall(present, misfits);
        logInfo("without the shadow of {} triangles beside a light: {}", triangles.size() - result.size(),
                fall.words());
        if (!fall.exceeds(0.01, 3)) continue;
        result = std::move(triangles);
        present = misfits;
        sinceAccepted = 0;
    }
    return result;
}

bool openBags(const Scene& scene, const RadianceSamples& samples, const EmitterClusters& emitters,
              const SolveOptions& options, std::vector<EmitterReplacement>& bodies, Progress& progress) {
    bool any = false;
    for (EmitterReplacement& r : bodies) {
        if (r.bag.empty() || falseObstacles(scene, samples, emitters, {r.bag}, options, progress).empty()) continue;
        r.place = std::move(r.whole);
        r.bag.clear();
        any = true;
    }
    return any;
}

}  // namespace relamp
