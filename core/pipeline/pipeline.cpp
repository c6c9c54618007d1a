#include "pipeline/pipeline.h"

#include "base/log.h"
#include "base/stage_meter.h"
#include "capture/own_axes.h"
#include "pipeline/normals_choice.h"
#include "pipeline/working_mesh.h"
#include "scene/smooth_normals.h"

namespace relamp {

ProxyLight proxyOf(const HiddenLight& light) { return {light.position, 0.015f * light.distance, light.sigma(), true}; }

namespace {

/// Looks for a lamp that no photograph shows; where there is one, a proxy joins the capture.
void addHiddenLight(PipelineResult& r, const PipelineOptions& options, Progress& progress) {
    const std::optional<DecimatedMesh> working = workingMesh(r.capture, options.meshTriangles, progress);
    const Scene scene = buildScene(working ? working->mesh : r.capture.mesh, progress, ownAxes(r.capture));
    const RadianceSamples samples = gatherRadiance(r.capture, scene, options.gather, progress);
    const EmitterClusters clusters = clusterEmitters(scene, r.capture, samples, options.clusters, progress);
    HiddenLightOptions search;
    search.seed = options.solve.seed;
    r.search = findHiddenLight(r.capture, scene, samples, clusters, search, progress);
    logInfo("{}", r.search->words);
    if (!r.search->light) return;
    const ProxyLight proxy = proxyOf(*r.search->light);
    addProxies({proxy}, r.capture.mesh);
    r.capture.proxies.push_back(proxy);
}

}  // namespace

PipelineResult runPipeline(const std::filesystem::path& captureFolder, const PipelineOptions& options, Progress& progress, const SolveListener* listener) {
    PipelineResult r;
    StageMeter meter(progress);
    // Photographs, cameras, mesh.
    meter.begin("photographs");
    r.capture = loadCapture(captureFolder, options.load, progress);
    if (options.findLight) {
        meter.begin("looking for an unseen lamp");
        addHiddenLight(r, options, progress);
    }
    const std::optional<SolveCheckpoint> earlier = options.resume ? options.resume(r.capture) : std::nullopt;
    meter.begin("scene");
    const std::optional<DecimatedMesh> working = workingMesh(r.capture, options.meshTriangles, progress);
    r.scene = buildScene(working ? working->mesh : r.capture.mesh, progress, ownAxes(r.capture));
    SolveListener carrying;
    if (working && listener && listener->snapshot) {
        carrying = *listener;
        carrying.snapshot = [&r, &working, listener](Estimate estimate) { listener->snapshot(carriedBack(estimate, *working, r.capture.mesh)); };
        listener = &carrying;
    }
    // What the photographs say of each vertex and of the environment.
    meter.begin("look-ups");
    r.samples = gatherRadiance(r.capture, r.scene, options.gather, progress);
    // High-radiance components become emitting patches ([Put15] 3.3).
    meter.begin("finding lamps");
    r.clusters = clusterEmitters(r.scene, r.capture, r.samples, options.clusters, progress);
    // Are the mesh's normals good enough to shade with? A decimated mesh's are means already.
    r.smoothedNormals = std::max(0, options.load.fix.smoothNormals);
    if (options.load.fix.smoothNormals < 0 && !working) {
        meter.begin("normals");
        if (const NormalsChoice choice = chooseNormals(r.scene, r.samples, r.clusters, options.solve, progress); choice.rounds > 0) {
            r.smoothedNormals = choice.rounds;
            r.capture.mesh.normals = smoothedNormals(r.capture.mesh, choice.rounds);
            r.capture.notes.push_back(fmt::format("the mesh's normals are noisy: smoothed {} times, ratios between points are explained {:.1f} % better", choice.rounds, 100 * choice.better));
            logInfo("{}", r.capture.notes.back());
            r.scene = buildScene(r.capture.mesh, progress, ownAxes(r.capture));
        }
    }
    // What this scene does not need.
    SolveOptions solve = options.solve;
    meter.begin("planning");
    if (!earlier) solve.plan = planSolve(r.capture, r.scene, r.samples, r.clusters, options.solve, options.everything, progress);
    meter.end();
    // Transport (visibility, near-field maps) and the two alternating programs: light (equations 3 to 6) and reflectance.
    if (options.onlyPlan) r.estimate.plan = solve.plan;
    else r.estimate = solveScene(r.capture, r.scene, r.samples, r.clusters, solve, progress, listener, earlier ? &*earlier : nullptr);
    if (working) {
        if (!options.onlyPlan) {
            r.estimate = carriedBack(r.estimate, *working, r.capture.mesh);
            r.estimate.leftOut.push_back({"triangles", fmt::format("the solve ran on {} of {}, and what it found was carried back", working->mesh.triangles.size(), r.capture.mesh.triangles.size())});
        }
        r.scene = buildScene(r.capture.mesh, progress, ownAxes(r.capture));
    }
    if (r.search && !r.search->light) r.estimate.leftOut.push_back({"unseen lamp", r.search->words});
    std::vector<PlannedStage> done;
    for (const StageCost& cost : meter.stages()) done.push_back({cost.name, -1, cost.seconds, -1, cost.mib});
    r.estimate.plan.stages.insert(r.estimate.plan.stages.begin(), done.begin(), done.end());
    return r;
}

}  // namespace relamp
