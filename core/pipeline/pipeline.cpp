#include "pipeline/pipeline.h"

#include "base/log.h"
#include "base/random.h"
#include "base/statistics.h"
#include "brdf/measured_gloss.h"
#include "capture/own_axes.h"
#include "clusters/shining_sides.h"
#include "clusters/state_emitters.h"
#include "pipeline/carry_corrections.h"
#include "pipeline/find_materials.h"
#include "pipeline/flatten_surfaces.h"
#include "pipeline/lean_normals.h"
#include "pipeline/mend_mesh.h"
#include "pipeline/normals_choice.h"
#include "pipeline/reproduction.h"
#include "pipeline/state_checks.h"
#include "pipeline/texture_stage.h"
#include "pipeline/working_mesh.h"
#include "radiance/mirror_spheres.h"
#include "radiance/state_parts.h"
#include "scene/smooth_normals.h"
#include "shot/checkpoint.h"
#include "solve/photometric_estimate.h"
#include "solve/registration/registration.h"

namespace relamp {

ProxyLight proxyOf(const UnobservedLight& light) {
    return {light.position, 0.015f * light.distance, light.sigma(), true, Rgb(0), light.lobe};
}

void chooseBasis(const std::string& name, const std::filesystem::path& merl, SolveOptions& options) {
    options.basis = basisNamed(name);
    if (!merl.empty())
        for (Lobe& lobe : readMeasuredLobes(merl)) options.basis.lobes.push_back(std::move(lobe));
    if (name != "built-in" || !merl.empty()) options.mostLobes = 3;
}

uint64_t fingerprintOf(const Capture& capture, const PipelineOptions& options) {
    uint64_t probes = 0;
    for (const LightProbe& probe : options.probes) probes = mixBits(probes ^ fingerprintOf(probe));
    for (const MirrorBall& ball : options.mirrorBalls) probes = mixBits(probes ^ fingerprintOf(ball));
    return solveFingerprint(capture, options.solve, options.everything) ^ probes ^
           (options.registration ? mixBits(0x726567) : 0) ^
           (options.meshTriangles ? mixBits(uint64_t(*options.meshTriangles)) : 0);
}

namespace {

/// Throws Error that says why, when no photograph has a pixel that counts.
void refuseWithoutPixels(const Capture& capture) {
    size_t all = 0, nan = 0, infinite = 0, negative = 0, transparent = 0;
    for (const View& view : capture.views) {
        if (view.image.usable.empty() ||
            std::find(view.image.usable.begin(), view.image.usable.end(), 1) != view.image.usable.end())
            return;
        all += view.image.usable.size();
        nan += view.imageReport.nan;
        infinite += view.imageReport.infinite;
        negative += view.imageReport.negative;
        transparent += view.imageReport.transparent;
    }
    const size_t masked = all - std::min(all, nan + infinite + negative + transparent);
    std::string reasons;
    for (const auto& [count, what] :
         {std::pair{nan, "are not a number"}, std::pair{infinite, "are infinite"}, std::pair{negative, "are negative"},
          std::pair{transparent, "are transparent"}, std::pair{masked, "are black in a mask"}})
        if (count)
            reasons +=
                fmt::format("{}{:.0f} % {}", reasons.empty() ? "" : ", ", 100.0 * double(count) / double(all), what);
    throw Error("every pixel of every photograph is left out: {}", reasons);
}

/// What the brightest lighting state says alone, of emitters as they are in it.
struct StatePart {
    std::shared_ptr<const RadianceSamples> samples;
    EmitterClusters clusters;
};

/// Of a capture with one state: all of it.
StatePart brightestPart(const Prepared& prepared) {
    if (prepared.samples->states == 1) return {prepared.samples, prepared.clusters};
    const uint32_t state = brightestState(prepared.clusters, *prepared.samples);
    return {std::make_shared<const RadianceSamples>(samplesOfState(*prepared.samples, state)),
            clustersInState(*prepared.scene, prepared.clusters, state)};
}

/// Brings floors and walls onto their planes. `shape`: see correctCapture.
void flatten(const PipelineOptions& options, Capture& capture, Prepared& prepared, RegistrationFix& fix,
             std::vector<Vec3>& shape, StageMeter& meter, Progress& progress) {
    const StatePart part = brightestPart(prepared);
    Capture ofState;
    if (capture.states.size() > 1)
        ofState = captureOfState(capture, brightestState(prepared.clusters, *prepared.samples));
    const FlattenedSurfaces flat =
        flattenSurfaces(capture.states.size() > 1 ? ofState : capture, *prepared.scene, *part.samples, part.clusters,
                        options.gather, options.solve, progress);
    if (flat.fix.empty()) return;
    for (const std::string& words : flat.words) {
        logInfo("{}", words);
        capture.notes.push_back(words);
    }
    fix.flatStep = flat.fix.flatStep;
    fix.flatSteps = flat.fix.flatSteps;
    const std::vector<Vec3> wavy = capture.mesh.positions;
    applyRegistration(flat.fix, capture.mesh);
    if (shape.empty()) shape = wavy;
    for (size_t v = 0; v < shape.size(); ++v) shape[v] += capture.mesh.positions[v] - wavy[v];
    prepared = prepare(capture, options, meter, progress, nullptr, capture.states.size() > 1 ? nullptr : flat.samples);
}

/// mendMesh by the photographs of the state in which emitters are brightest.
MeshMend mendByBrightestState(const PipelineOptions& options, Capture& capture, Prepared& prepared,
                              const std::vector<Vec3>& shape, StageMeter& meter, Progress& progress) {
    if (capture.states.size() <= 1) return mendMesh(options, capture, prepared, shape, meter, progress);
    const uint32_t state = brightestState(prepared.clusters, *prepared.samples);
    Capture part = captureOfState(capture, state);
    const size_t proxies = part.proxies.size();
    Prepared ofPart = prepared;
    ofPart.samples = std::make_shared<const RadianceSamples>(samplesOfPart(*prepared.samples, state));
    ofPart.clusters = clustersInState(*prepared.scene, prepared.clusters, state);
    MeshMend mend = mendMesh(options, part, ofPart, shape, meter, progress);
    capture.notes.insert(capture.notes.end(), part.notes.begin(), part.notes.end());
    if (!mend.reshapes() && part.proxies.size() == proxies) return mend;
    capture.mesh = std::move(part.mesh);
    capture.proxies = std::move(part.proxies);
    prepared = prepare(capture, options, meter, progress);
    return mend;
}

}  // namespace

Prepared prepare(const Capture& capture, const PipelineOptions& options, StageMeter& meter, Progress& progress,
                 std::shared_ptr<const Scene> scene, std::shared_ptr<const RadianceSamples> samples) {
    refuseWithoutPixels(capture);
    Prepared p;
    meter.begin(Stage::scene);
    p.working = workingMesh(capture, options.meshTriangles, progress);
    if (!scene || p.working)
        scene = std::make_shared<const Scene>(
            buildScene(p.working ? p.working->mesh : capture.mesh, progress, ownAxes(capture)));
    p.scene = std::move(scene);
    // What the photographs say of each vertex and of the environment.
    meter.begin(Stage::observations);
    GatherOptions gather = options.gather;
    // Where no light is near, an emitter that is switched is another distant light.
    gather.ownEnvironments |= !options.solve.nearField && capture.states.size() > 1;
    if (!samples || p.working || gather.ownEnvironments)
        samples = std::make_shared<const RadianceSamples>(gatherRadiance(capture, *p.scene, gather, progress));
    p.samples = std::move(samples);
    // High-radiance components become emitting patches ([Put15] 3.3).
    meter.begin(Stage::emitters);
    p.clusters = clusterEmittersOfStates(*p.scene, capture, *p.samples, options.clusters, progress);
    return p;
}

namespace {

/// Of a working mesh: those of a coarser one are farther off themselves than what is to be put right.
constexpr size_t enoughTriangles = 50'000;

/// Relief that the mesh has lost, in its normals.
void lean(const PipelineOptions& options, Capture& capture, Prepared& prepared, Corrections& done, StageMeter& meter,
          Progress& progress) {
    meter.begin(Stage::normals);
    const Scene& scene = *prepared.scene;
    const size_t added = done.mend.addedPositions.size() + capture.proxies.size() * proxyVertices;
    const std::vector<uint8_t> known =
        knownNormals(scene, scene.mesh.vertexCount() - added, done.registration, done.mend);
    const StatePart part = brightestPart(prepared);
    const LeantNormals found = leanNormals(scene, *part.samples, part.clusters, known, options.solve, progress);
    if (found.turned.empty()) return;
    capture.notes.push_back(found.words);
    for (const MeshMend::TurnedVertex& t : found.turned) capture.mesh.normals[t.vertex] = glm::normalize(t.normal);
    done.mend.turned.insert(done.mend.turned.end(), found.turned.begin(), found.turned.end());
    prepared = prepare(capture, options, meter, progress);
}

bool isMended(const CaptureFix& told) {
    return !told.mend.empty() ||
           std::any_of(told.proxies.begin(), told.proxies.end(), [](const ProxyLight& p) { return p.observed(); });
}

/// Cameras, mesh, exposures and normals; see correctCapture.
Corrections correctMesh(const PipelineOptions& options, Capture& capture, Prepared& prepared, StageMeter& meter,
                        Progress& progress) {
    const CaptureFix& told = options.load.fix;
    Corrections done{told.registration, told.photometric, told.mend, std::max(0, told.smoothNormals)};
    const bool mended = isMended(told);
    std::vector<Vec3> shape;  // of a mesh that registration moved, without what it did to outlines
    if (!done.registration.empty()) shape = capture.mesh.positions;
    // Do the photographs agree on the mesh?
    if (options.registration && done.registration.empty() && !mended) {
        meter.begin(Stage::registration);
        const size_t own = capture.mesh.vertexCount() - capture.proxies.size() * proxyVertices;
        RegistrationTask task{own, !prepared.working};
        const auto estimate = [&] {
            task.emits = verticesOf(*prepared.scene, {&prepared.clusters.emitters});
            task.mirrors =
                verticesOfSpheres(mirrorSpheres(*prepared.scene, *prepared.samples, task.emits), task.emits.size());
            return estimateRegistration(capture, *prepared.scene, *prepared.samples, task, progress);
        };
        std::vector<Camera> given;
        for (const View& view : capture.views) given.push_back(view.camera);
        RegistrationEstimate found = estimate();
        if (!found.farPoses.empty()) {
            logInfo("{}", farText(found));
            capture.notes.push_back(farText(found));
            done.registration.poses = found.farPoses;
            applyRegistration(done.registration, capture);
            prepared = prepare(capture, options, meter, progress);
            task.farCameras = false;
            task.afterFar = true;
            found = estimate();
        }
        logInfo("{}{}", toText(found), found.needed() ? "; moved" : "; left as it is");
        if (found.needed()) {
            capture.notes.push_back("cameras and mesh do not quite fit: " + toText(found));
            const std::vector<PoseFix> first = std::move(done.registration.poses);
            done.registration = found.fix;
            RegistrationFix apartFromOutlines = found.fix;
            apartFromOutlines.outlineSteps.clear();
            Mesh moved = capture.mesh;
            applyRegistration(apartFromOutlines, moved);
            shape = std::move(moved.positions);
            applyRegistration(done.registration, capture);
            std::vector<PoseFix>& poses = done.registration.poses;
            if (poses.empty()) poses = first;
            else
                for (size_t i = 0; i < first.size(); ++i) poses[i] = composed(first[i], poses[i]);
            // To the bit what a shot that keeps the poses comes to.
            for (size_t i = 0; i < first.size(); ++i) capture.views[i].camera = corrected(given[i], poses[i]);
            prepared = prepare(capture, options, meter, progress);
        }
        if (!prepared.working) flatten(options, capture, prepared, done.registration, shape, meter, progress);
    }
    // Do exposures differ from photograph to photograph?
    if (options.photometric && done.photometric.empty()) {
        meter.begin(Stage::exposures);
        const PhotometricEstimate found = estimatePhotometric(capture, *prepared.scene, *prepared.samples, progress);
        logInfo("{}{}", toText(found), found.needed() ? "; taken out" : "; left as it is");
        if (found.needed() && !found.fix.empty()) {
            done.photometric = found.fix;
            for (View& view : capture.views) applyPhotometric(done.photometric, view);
            prepared = prepare(capture, options, meter, progress, prepared.working ? nullptr : prepared.scene);
        }
    }
    if (options.mend && !mended && !prepared.working)
        done.mend = mendByBrightestState(options, capture, prepared, shape, meter, progress);
    // Are the mesh's normals good enough to shade with? A decimated mesh's are means already.
    if (told.smoothNormals < 0 && !prepared.working) {
        meter.begin(Stage::normals);
        const StatePart part = brightestPart(prepared);
        if (const NormalsChoice choice =
                chooseNormals(*prepared.scene, *part.samples, part.clusters, options.solve, progress);
            choice.rounds > 0) {
            done.smoothedNormals = choice.rounds;
            capture.mesh.normals = smoothedNormals(capture.mesh, choice.rounds);
            capture.notes.push_back(fmt::format(
                "the mesh's normals are noisy: smoothed {} times, ratios between points are explained {:.1f} % better",
                choice.rounds, 100 * choice.better));
            logInfo("{}", capture.notes.back());
            prepared.scene = std::make_shared<const Scene>(buildScene(capture.mesh, progress, ownAxes(capture)));
        }
    }
    const bool inexact = !done.registration.empty() || done.mend.reshapes();
    if (options.mend && !mended && inexact && done.smoothedNormals == 0 && !prepared.working)
        lean(options, capture, prepared, done, meter, progress);
    return done;
}

/// The same of a large mesh: found on its working mesh and carried back.
Corrections correctLargeMesh(const PipelineOptions& options, Capture& capture, Prepared& prepared, StageMeter& meter,
                             Progress& progress) {
    DecimatedMesh working = std::move(*prepared.working);
    prepared.working.reset();
    Mesh whole = std::exchange(capture.mesh, working.mesh);
    const size_t proxies = capture.proxies.size();
    PipelineOptions small = options;
    small.meshTriangles = 0;
    // A decimated mesh's are means already.
    small.load.fix.smoothNormals = std::max(0, options.load.fix.smoothNormals);
    const Corrections found = correctMesh(small, capture, prepared, meter, progress);
    RegistrationFix shape = found.registration;
    shape.poses.clear();  // cameras have theirs
    if (shape.empty() && found.mend.empty()) {
        capture.mesh = std::move(whole);
        prepared.working = std::move(working);
        return found;
    }
    whole = withoutProxies(std::move(whole), proxies);
    working.mesh = withoutProxies(std::move(working.mesh), proxies);
    working.places.resize(whole.vertexCount());
    std::vector<Vec3> corrected = std::move(capture.mesh.positions);
    corrected.resize(working.mesh.vertexCount());
    const Corrections done = carriedBack(found, working, corrected, whole);
    shape = done.registration;
    shape.poses.clear();
    capture.mesh = std::move(whole);
    applyRegistration(shape, capture.mesh);
    applyMend(done.mend, capture.mesh);
    addProxies(capture.proxies, capture.mesh);
    prepared = prepare(capture, options, meter, progress);
    return done;
}

}  // namespace

Corrections correctCapture(const PipelineOptions& options, Capture& capture, Prepared& prepared, StageMeter& meter,
                           Progress& progress) {
    warnOfOtherEnvironments(capture, *prepared.samples);
    const CaptureFix& told = options.load.fix;
    const bool large = prepared.working && prepared.working->mesh.triangles.size() >= enoughTriangles &&
                       told.registration.empty() && !isMended(told);
    Corrections done = large ? correctLargeMesh(options, capture, prepared, meter, progress)
                             : correctMesh(options, capture, prepared, meter, progress);
    if (prepared.working) {
        letSidesShine(*prepared.scene, inWorkingMesh(done.mend.shining, *prepared.working), prepared.clusters);
        letBacksShine(inWorkingMesh(done.mend.bothSides, *prepared.working), prepared.clusters);
    } else {
        letSidesShine(*prepared.scene, done.mend.shining, prepared.clusters);
        letBacksShine(done.mend.bothSides, prepared.clusters);
    }
    const bool exact = done.registration.empty() && !done.mend.reshapes();
    if (options.materials && options.solve.nearField) {
        meter.begin(Stage::planning);
        const StatePart part = brightestPart(prepared);
        if (auto parted =
                findMaterials(capture, *prepared.scene, *part.samples, part.clusters, exact, options.solve, progress))
            prepared.scene = std::move(parted);
    }
    if (!exact) prepared.meshError = halfAnEdge(*prepared.scene);
    return done;
}

void takeMirrorBalls(PipelineOptions& options, Capture& capture) {
    for (const MirrorBall& ball : options.mirrorBalls) options.probes.push_back(probeOf(ball, capture));
}

UnobservedLightSearch searchUnobservedLight(const Capture& capture, const PipelineOptions& options, Progress& progress,
                                            std::shared_ptr<const Scene> scene,
                                            std::shared_ptr<const RadianceSamples> samples) {
    StageMeter meter(progress);
    const Prepared p = prepare(capture, options, meter, progress, std::move(scene), std::move(samples));
    UnobservedLightOptions search;
    search.seed = options.solve.seed;
    UnobservedLightSearch found;
    if (p.samples->states == 1) {
        found = findUnobservedLights(capture, *p.scene, *p.samples, p.clusters, search, progress);
    } else {
        // A light may be off in some of the states, and clear in one alone.
        std::vector<UnobservedLightSearch> ofState;
        for (uint32_t s = 0; s < p.samples->states; ++s)
            ofState.push_back(findUnobservedLights(captureOfState(capture, s), *p.scene, samplesOfPart(*p.samples, s),
                                                   clustersInState(*p.scene, p.clusters, s), search, progress));
        found = joinedSearches(capture.states, ofState);
    }
    logInfo("{}", found.words);
    return found;
}

namespace {

/// By the brightest lighting state.
std::optional<SuspectedLight> suspectedLight(const Capture& capture, const Prepared& prepared, uint64_t seed,
                                             Progress& progress) {
    const RadianceSamples& samples = *prepared.samples;
    if (samples.states == 1)
        return suspectUnobservedLight(capture, *prepared.scene, samples, prepared.clusters, seed, progress);
    const uint32_t state = brightestState(prepared.clusters, samples);
    return suspectUnobservedLight(captureOfState(capture, state), *prepared.scene, samplesOfPart(samples, state),
                                  clustersInState(*prepared.scene, prepared.clusters, state), seed, progress);
}

}  // namespace

Estimate solvePrepared(const Capture& capture, const Scene& whole, const Prepared& prepared,
                       const PipelineOptions& options, StageMeter& meter, Progress& progress,
                       const SolveExtras& extras) {
    const Scene& scene = *prepared.scene;
    const SolveListener* listener = extras.listener;
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
    solve.meshError = prepared.meshError;
    const StatePart part = brightestPart(prepared);
    if (part.samples != prepared.samples)
        solve.probedEnvironment =
            size_t(std::max(0, prepared.samples->environmentOf(brightestState(prepared.clusters, *prepared.samples))));
    const std::vector<ProbeFit> probes =
        fitProbes(options.probes, scene, *part.samples, part.clusters, options.solve, solve.probes, progress);
    meter.begin(Stage::planning);
    if (options.plan && !extras.resume)
        solve.plan =
            planSolve(capture, scene, *part.samples, part.clusters, options.solve, options.everything, progress);
    if (options.plan && !options.findLight && !extras.resume && !progress.hasBudget())
        solve.plan.suspectedLight = suspectedLight(capture, prepared, options.solve.seed, progress);
    if (solve.plan.suspectedLight) logInfo("{} --find-light looks for it", inWords(*solve.plan.suspectedLight));
    if (prepared.samples->states > 1) countAllStates(*prepared.samples, *part.samples, solve.plan);
    if (options.plan && !extras.resume)
        planTexture(capture, scene, *prepared.samples, options.texture, options.everything, solve.plan);
    meter.end();
    if (extras.planned) extras.planned(extras.resume ? extras.resume->plan : solve.plan);
    // Transport (visibility, near-field maps) and the two alternating programs: light (equations 3 to 6) and
    // reflectance.
    if (options.onlyPlan) {
        Estimate plan;
        plan.plan = solve.plan;
        return plan;
    }
    Estimate estimate = carried(
        solveScene(capture, scene, *prepared.samples, prepared.clusters, solve, progress, listener, extras.resume));
    takeProbes(probes, estimate);
    if (prepared.working)
        estimate.leftOut.push_back(
            {Omission::triangles, fmt::format("the solve ran on {} of {}, and what it found was carried back",
                                              scene.mesh.triangles.size(), capture.mesh.triangles.size())});
    meter.begin(Stage::texture);
    addTexture(capture, whole, options.texture, estimate, progress);
    addBackgrounds(capture, *prepared.samples, estimate, progress);
    meter.end();
    if (options.reproduce) {
        meter.begin(Stage::reproduction);
        ReproductionOptions measure;
        measure.pixels = std::clamp<size_t>(
            (progress.outOfTime() ? 4000 : 24000) / std::max<size_t>(1, capture.views.size()), 300, 3000);
        estimate.reproduction =
            measureReproduction(capture, whole, estimate, scene, *prepared.samples, measure, progress);
        meter.end();
    }
    estimate.heldOut.clear();
    estimate.heldOutTexture.reset();
    if (estimate.reproduction.measured()) logInfo("{}", toText(estimate.reproduction));
    std::vector<PlannedStage> done;
    for (const StageCost& cost : meter.stages()) {
        const auto planned = std::find_if(estimate.plan.stages.begin(), estimate.plan.stages.end(),
                                          [&](const PlannedStage& s) { return s.stage == cost.stage; });
        if (planned == estimate.plan.stages.end()) {
            done.push_back({cost.stage, -1, cost.seconds, -1, cost.mib});
        } else {
            planned->measuredSeconds = cost.seconds;
            planned->measuredMib = cost.mib;
        }
    }
    estimate.plan.stages.insert(estimate.plan.stages.begin(), done.begin(), done.end());
    return estimate;
}

PipelineResult runPipeline(const std::filesystem::path& captureFolder, const PipelineOptions& asked, Progress& progress,
                           const SolveListener* listener) {
    PipelineOptions options = asked;
    PipelineResult r;
    StageMeter meter(progress);
    // Photographs, cameras, mesh.
    meter.begin(Stage::photographs);
    r.capture = loadCapture(captureFolder, options.load, progress);
    takeMirrorBalls(options, r.capture);
    if (options.findLight) {
        meter.begin(Stage::unobservedLight);
        r.search = searchUnobservedLight(r.capture, options, progress);
        std::vector<ProxyLight> found;
        for (const UnobservedLight& light : r.search->lights) found.push_back(proxyOf(light));
        addProxies(found, r.capture.mesh);
        r.capture.proxies.insert(r.capture.proxies.end(), found.begin(), found.end());
    }
    const std::optional<SolveCheckpoint> earlier = options.resume ? options.resume(r.capture) : std::nullopt;
    Prepared prepared = prepare(r.capture, options, meter, progress);
    r.corrections = correctCapture(options, r.capture, prepared, meter, progress);
    r.scene = prepared.working ? std::make_shared<const Scene>(buildScene(r.capture.mesh, progress, ownAxes(r.capture)))
                               : prepared.scene;
    r.estimate = solvePrepared(r.capture, *r.scene, prepared, options, meter, progress,
                               {listener, earlier ? &*earlier : nullptr, {}});
    r.samples = std::move(prepared.samples);
    r.clusters = std::move(prepared.clusters);
    if (r.search && r.search->lights.empty())
        r.estimate.leftOut.push_back({Omission::unobservedLight, r.search->words});
    return r;
}

}  // namespace relamp
