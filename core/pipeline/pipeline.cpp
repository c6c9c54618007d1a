#include "pipeline/pipeline.h"

#include "base/log.h"
#include "base/stage_meter.h"
#include "capture/own_axes.h"
#include "pipeline/normals_choice.h"
#include "pipeline/reproduction.h"
#include "pipeline/working_mesh.h"
#include "scene/smooth_normals.h"
#include "solve/photometric_estimate.h"

namespace relamp {

ProxyLight proxyOf(const UnobservedLight& light) {
    return {light.position, 0.015f * light.distance, light.sigma(), true};
}

namespace {

/// Looks for an emitter that no photograph shows; where there is one, a proxy joins the capture.
void addUnobservedLight(PipelineResult& r, const PipelineOptions& options, Progress& progress) {
    const std::optional<DecimatedMesh> working = workingMesh(r.capture, options.meshTriangles, progress);
    const Scene scene = buildScene(working ? working->mesh : r.capture.mesh, progress, ownAxes(r.capture));
    const RadianceSamples samples = gatherRadiance(r.capture, scene, options.gather, progress);
    const EmitterClusters clusters = clusterEmitters(scene, r.capture, samples, options.clusters, progress);
    UnobservedLightOptions search;
    search.seed = options.solve.seed;
    r.search = findUnobservedLight(r.capture, scene, samples, clusters, search, progress);
    logInfo("{}", r.search->words);
    if (!r.search->light) return;
    const ProxyLight proxy = proxyOf(*r.search->light);
    addProxies({proxy}, r.capture.mesh);
    r.capture.proxies.push_back(proxy);
}

}  // namespace

Prepared prepare(const Capture& capture, const PipelineOptions& options, StageMeter& meter, Progress& progress,
                 std::shared_ptr<const Scene> scene, std::shared_ptr<const RadianceSamples> samples) {
    Prepared p;
    meter.begin("scene");
    p.working = workingMesh(capture, options.meshTriangles, progress);
    if (!scene || p.working)
        scene = std::make_shared<const Scene>(
            buildScene(p.working ? p.working->mesh : capture.mesh, progress, ownAxes(capture)));
    p.scene = std::move(scene);
    // What the photographs say of each vertex and of the environment.
    meter.begin("look-ups");
    if (!samples || p.working)
        samples = std::make_shared<const RadianceSamples>(gatherRadiance(capture, *p.scene, options.gather, progress));
    p.samples = std::move(samples);
    // High-radiance components become emitting patches ([Put15] 3.3).
    meter.begin("finding lights");
    p.clusters = clusterEmitters(*p.scene, capture, *p.samples, options.clusters, progress);
    return p;
}

Estimate solvePrepared(const Capture& capture, const Scene& whole, const Prepared& prepared,
                       const PipelineOptions& options, StageMeter& meter, Progress& progress,
                       const SolveListener* listener, const SolveCheckpoint* resume,
                       const std::function<void(const SolvePlan&)>& planned) {
    const Scene& scene = *prepared.scene;
    const auto carried = [&](Estimate&& estimate) {
        return prepared.working ? carriedBack(estimate, *prepared.working, capture.mesh) : std::move(estimate);
    };
    SolveListener measuring;
    if (listener && listener->snapshot) {
        measuring = *listener;
        measuring.snapshot = [&, listener](Estimate found) {
            Estimate estimate = carried(std::move(found));
            estimate.reproduction =
                measureReproduction(capture, whole, estimate, scene, *prepared.samples, {300, false}, progress);
            listener->snapshot(std::move(estimate));
        };
        listener = &measuring;
    }
    // What this scene does not need.
    SolveOptions solve = options.solve;
    meter.begin("planning");
    if (!resume)
        solve.plan = planSolve(capture, scene, *prepared.samples, prepared.clusters, options.solve, options.everything,
                               progress);
    meter.end();
    if (planned && !resume) planned(solve.plan);
    // Transport (visibility, near-field maps) and the two alternating programs: light (equations 3 to 6) and
    // reflectance.
    if (options.onlyPlan) {
        Estimate plan;
        plan.plan = solve.plan;
        return plan;
    }
    Estimate estimate =
        carried(solveScene(capture, scene, *prepared.samples, prepared.clusters, solve, progress, listener, resume));
    if (prepared.working)
        estimate.leftOut.push_back(
            {"triangles", fmt::format("the solve ran on {} of {}, and what it found was carried back",
                                      scene.mesh.triangles.size(), capture.mesh.triangles.size())});
    meter.begin("reproduction of the photographs");
    ReproductionOptions measure;
    measure.pixels = std::clamp<size_t>(
        (progress.outOfTime() ? 4000 : 24000) / std::max<size_t>(1, capture.views.size()), 300, 3000);
    estimate.reproduction = measureReproduction(capture, whole, estimate, scene, *prepared.samples, measure, progress);
    meter.end();
    estimate.heldOut.clear();
    if (estimate.reproduction.measured()) logInfo("{}", toText(estimate.reproduction));
    std::vector<PlannedStage> done;
    for (const StageCost& cost : meter.stages()) done.push_back({cost.name, -1, cost.seconds, -1, cost.mib});
    estimate.plan.stages.insert(estimate.plan.stages.begin(), done.begin(), done.end());
    return estimate;
}

CaptureFix fixOf(const PipelineResult& result, CaptureFix asked) {
    asked.smoothNormals = result.smoothedNormals;
    asked.photometric = result.photometric;
    asked.proxies = result.capture.proxies;
    for (ProxyLight& p : asked.proxies) p.centre += result.capture.origin;
    return asked;
}

PhotometricFix choosePhotometric(const Capture& capture, const Prepared& prepared, Progress& progress) {
    const PhotometricEstimate found = estimatePhotometric(capture, *prepared.scene, *prepared.samples, progress);
    logInfo("{}{}", toText(found), found.needed() ? "; taken out" : "; left as it is");
    return found.needed() ? found.fix : PhotometricFix{};
}

PipelineResult runPipeline(const std::filesystem::path& captureFolder, const PipelineOptions& options,
                           Progress& progress, const SolveListener* listener) {
    PipelineResult r;
    StageMeter meter(progress);
    // Photographs, cameras, mesh.
    meter.begin("photographs");
    r.capture = loadCapture(captureFolder, options.load, progress);
    if (options.findLight) {
        meter.begin("looking for an unobserved light");
        addUnobservedLight(r, options, progress);
    }
    const std::optional<SolveCheckpoint> earlier = options.resume ? options.resume(r.capture) : std::nullopt;
    Prepared prepared = prepare(r.capture, options, meter, progress);
    // Do exposures differ from photograph to photograph?
    r.photometric = options.load.fix.photometric;
    if (options.photometric && r.photometric.empty()) {
        meter.begin("exposures");
        r.photometric = choosePhotometric(r.capture, prepared, progress);
        if (!r.photometric.empty()) {
            for (View& view : r.capture.views) applyPhotometric(r.photometric, view);
            prepared = prepare(r.capture, options, meter, progress, prepared.working ? nullptr : prepared.scene);
        }
    }
    // Are the mesh's normals good enough to shade with? A decimated mesh's are means already.
    r.smoothedNormals = std::max(0, options.load.fix.smoothNormals);
    if (options.load.fix.smoothNormals < 0 && !prepared.working) {
        meter.begin("normals");
        if (const NormalsChoice choice =
                chooseNormals(*prepared.scene, *prepared.samples, prepared.clusters, options.solve, progress);
            choice.rounds > 0) {
            r.smoothedNormals = choice.rounds;
            r.capture.mesh.normals = smoothedNormals(r.capture.mesh, choice.rounds);
            r.capture.notes.push_back(fmt::format(
                "the mesh's normals are noisy: smoothed {} times, ratios between points are explained {:.1f} % better",
                choice.rounds, 100 * choice.better));
            logInfo("{}", r.capture.notes.back());
            prepared.scene = std::make_shared<const Scene>(buildScene(r.capture.mesh, progress, ownAxes(r.capture)));
        }
    }
    r.scene = prepared.working ? std::make_shared<const Scene>(buildScene(r.capture.mesh, progress, ownAxes(r.capture)))
                               : prepared.scene;
    r.estimate =
        solvePrepared(r.capture, *r.scene, prepared, options, meter, progress, listener, earlier ? &*earlier : nullptr);
    r.samples = std::move(prepared.samples);
    r.clusters = std::move(prepared.clusters);
    if (r.search && !r.search->light) r.estimate.leftOut.push_back({"unobserved light", r.search->words});
    return r;
}

}  // namespace relamp
