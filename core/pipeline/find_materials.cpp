#include "pipeline/find_materials.h"

#include "base/log.h"
#include "pipeline/plan_pilot.h"
#include "solve/gloss/glossy_regions.h"

namespace relamp {

std::shared_ptr<const Scene> findMaterials(const Capture& capture, const Scene& scene, const RadianceSamples& samples,
                                           const EmitterClusters& clusters, bool exact, const SolveOptions& options,
                                           Progress& progress) {
    const EmitterClusters emitters = allEmitters(scene, clusters, options.nearField);
    std::vector<uint8_t> skip(scene.mesh.vertexCount(), 0);
    for (size_t v = 0; v < skip.size(); ++v) skip[v] = emitters.emitterOfVertex[v] >= 0;
    if (!mayHaveParts(scene, samples, skip, exact)) return nullptr;
    const double start = progress.seconds();
    const RatioObservations observed = ratioObservations(scene, samples, skip, options.seed);
    const PilotFindings pilot = runPilot(scene, samples, emitters, observed.matte, observed.pairs, options, progress);
    if (!pilot.ran) return nullptr;
    std::vector<EmitterSurface> surfaces;
    for (const EmitterCluster& e : emitters.emitters) surfaces.push_back(orderedEmitterSurface(scene, e));
    const std::vector<GlossyRegion> regions =
        glossyRegions(capture, scene, samples, surfaces, emitters.emitterOfTriangle, observed.matte, skip,
                      pilot.lighting, {.seed = options.seed}, progress);
    logInfo("parts of surfaces that shine: {}, found in {:.2f} s", regions.size(), progress.seconds() - start);
    if (regions.empty()) return nullptr;
    auto parted = std::make_shared<Scene>(scene);
    for (const GlossyRegion& region : regions) {
        logInfo("{} of component {} changes with the view as a coating does ({} vertices, evidence {:.0f})",
                region.whole ? "most" : "a part", region.component, region.vertices.size(), region.evidence);
        if (region.whole) {
            parted->shines[region.component] = 1;
            continue;
        }
        for (const uint32_t v : region.vertices) parted->material[v] = parted->materials;
        ++parted->materials;
        parted->shines.push_back(1);
    }
    return parted;
}

}  // namespace relamp
