#include "pipeline/normals_choice.h"

#include "base/log.h"
#include "base/statistics.h"
#include "pipeline/plan_pilot.h"
#include "scene/smooth_normals.h"

namespace relamp {

bool normalsLookNoisy(const Scene& scene) {
    // Noise is everywhere on a mesh; detail and creases are in places.
    constexpr float noise = 0.02f;
    const std::vector<Vec3> smoother = smoothedNormals(scene.mesh, 2);
    std::vector<float> change;
    for (size_t v = 0; v < smoother.size(); ++v)
        if (scene.referenced[v]) change.push_back(glm::distance(smoother[v], scene.mesh.normals[v]));
    return medianOf(std::move(change)) >= noise;
}

NormalsChoice chooseNormals(const Scene& scene, const RadianceSamples& samples, const EmitterClusters& emitters,
                            const SolveOptions& options, Progress& progress) {
    NormalsChoice choice;
    if (!normalsLookNoisy(scene)) return choice;
    std::vector<uint8_t> skip(scene.mesh.vertexCount(), 0);
    for (size_t v = 0; v < skip.size(); ++v) skip[v] = emitters.emitterOfVertex[v] >= 0;
    const RatioObservations observed = ratioObservations(scene, samples, std::move(skip), options.seed);
    if (observed.pairs.size() < 1000) return choice;
    const std::vector<double> asTheyAre =
        pilotMisfits(scene, samples, emitters, observed.matte, observed.pairs, options, progress);
    std::vector<double> best = asTheyAre;
    for (const int rounds : {2, 6}) {
        Scene smoother = scene;
        smoother.mesh.normals = smoothedNormals(scene.mesh, rounds);
        const std::vector<double> misfits =
            pilotMisfits(smoother, samples, emitters, observed.matte, observed.pairs, options, progress);
        const MisfitFall fall = misfitFall(asTheyAre, misfits);
        logInfo("normals smoothed {} times: {}", rounds, fall.words());
        if (!fall.exceeds(0.015, 4) || !(misfitFall(best, misfits).part > 0)) break;
        choice = {rounds, fall.part};
        best = misfits;
    }
    return choice;
}

}  // namespace relamp
