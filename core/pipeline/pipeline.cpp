#include "pipeline/pipeline.h"

#include "base/stage_meter.h"

namespace relamp {

PipelineResult runPipeline(const std::filesystem::path& captureFolder, const PipelineOptions& options, Progress& progress, const SolveListener* listener) {
    PipelineResult r;
    StageMeter meter(progress);
    // Photographs, cameras, mesh.
    meter.begin("photographs");
    r.capture = loadCapture(captureFolder, options.load, progress);
    const std::optional<SolveCheckpoint> earlier = options.resume ? options.resume(r.capture) : std::nullopt;
    meter.begin("scene");
    r.scene = buildScene(r.capture.mesh, progress);
    // What the photographs say of each vertex and of the environment.
    meter.begin("look-ups");
    r.samples = gatherRadiance(r.capture, r.scene, options.gather, progress);
    // High-radiance components become emitting patches ([Put15] 3.3).
    meter.begin("finding lamps");
    r.clusters = clusterEmitters(r.scene, r.capture, r.samples, options.clusters, progress);
    // What this scene does not need.
    SolveOptions solve = options.solve;
    meter.begin("planning");
    if (!earlier) solve.plan = planSolve(r.capture, r.scene, r.samples, r.clusters, options.solve, options.everything, progress);
    meter.end();
    // Transport (visibility, near-field maps) and the two alternating programs: light (equations 3 to 6) and reflectance.
    if (options.onlyPlan) r.estimate.plan = solve.plan;
    else r.estimate = solveScene(r.capture, r.scene, r.samples, r.clusters, solve, progress, listener, earlier ? &*earlier : nullptr);
    std::vector<PlannedStage> done;
    for (const StageCost& cost : meter.stages()) done.push_back({cost.name, -1, cost.seconds, -1, cost.mib});
    r.estimate.plan.stages.insert(r.estimate.plan.stages.begin(), done.begin(), done.end());
    return r;
}

}  // namespace relamp
