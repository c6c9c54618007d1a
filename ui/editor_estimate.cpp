// Estimating in the background, going on with an estimate that was interrupted, and the search for an unobserved light.
#include "base/parallel.h"

#include "editor_impl.h"
#include "interrupted.h"
#include "pipeline/time_left.h"
#include "settings.h"
#include "thumbnails.h"

namespace relamp::ui {
namespace fs = std::filesystem;

/// What an estimate takes from the editor to its own thread.
struct Editor::Impl::EstimateInputs {
    SolveRequest request;
    std::shared_ptr<const Capture> capture;
    std::shared_ptr<const Scene> scene;
    std::shared_ptr<const RadianceSamples> samples;
    InterruptedEstimate kept;  ///< as it is to be found if it does not come to its end
    bool goOn = false;         ///< where an earlier one stood
};

bool Editor::stale() const {
    if (!impl_->solvedWith || !estimate()) return false;
    const SolveRequest &a = *impl_->solvedWith, &b = state.solve;
    return a.quality != b.quality || a.seed != b.seed || a.gauge.kind != b.gauge.kind ||
           a.gauge.albedo != b.gauge.albedo || a.gauge.whiteAlbedo != b.gauge.whiteAlbedo ||
           a.gauge.emitter != b.gauge.emitter || a.gauge.radiance != b.gauge.radiance || a.gauge.view != b.gauge.view ||
           a.gauge.pixel != b.gauge.pixel || a.palette != b.palette || a.lightSmoothness != b.lightSmoothness ||
           a.albedoSmoothness != b.albedoSmoothness || a.basis != b.basis || a.merl != b.merl || a.bounce != b.bounce ||
           a.meshTriangles != b.meshTriangles || a.texture != b.texture || a.lightProbes != b.lightProbes ||
           a.marks != b.marks;
}

void Editor::solve(const SolveRequest& request) { impl_->solve(request, false); }

void Editor::answerInterrupted(bool goOn) {
    if (!state.interrupted || impl_->job) return;
    const InterruptedEstimate offer = *state.interrupted;
    if (!goOn) {
        state.interrupted.reset();
        discardInterrupted(offer.record);
        return;
    }
    if (state.document.capture && state.document.captureFolder == offer.captureFolder) {
        state.solve = offer.request;
        impl_->solve(offer.request, true);
        return;
    }
    state.interrupted.reset();
    impl_->goOnWhenOpen = offer.record;
    openNow(offer.project);
    if (!impl_->job) impl_->goOnWhenOpen.clear();
}

void Editor::Impl::offerInterrupted(const std::optional<InterruptedEstimate>& found) {
    self.state.interrupted = found;
    const fs::path wanted = std::exchange(goOnWhenOpen, {});
    if (wanted.empty()) return;
    if (found && found->record == wanted) self.answerInterrupted(true);
    else if (!found)
        self.fail("The interrupted estimate cannot go on", "Its capture, or relamp, has changed since.",
                  "Estimate again with Ctrl+Enter.");
}

void Editor::Impl::solve(const SolveRequest& request, bool goOn) {
    const Document& document = self.state.document;
    if (!document.capture) return;
    if (!document.samples) {
        self.fail("The photographs are missing",
                  "Estimating needs the capture's photographs, and they could not be read.",
                  "Put them back and open the capture again.");
        return;
    }
    if (refusedWhileRunning()) return;
    self.autosave();
    self.state.interrupted.reset();
    const size_t which = request.nearField ? 0 : 1;
    self.state.curves[which] = {};
    self.state.curves[which].running = true;
    solveIsNearField = request.nearField;
    solveBudget = request.budgetSeconds;
    planHeardAt.reset();
    shownOnce = self.estimate() != nullptr;
    self.state.panels.bottomFolded = false;
    self.state.panels.bottomTab = 0;
    {
        std::lock_guard lock(solveMutex);
        newEntries.clear();
        newSnapshot.reset();
        newPlan.reset();
    }
    EstimateInputs inputs{request, document.capture, document.scene, document.samples, {}, goOn};
    inputs.kept.record = interruptedRecord(options.stateFolder, document.captureFolder);
    inputs.kept.captureFolder = document.captureFolder;
    inputs.kept.project = documentPath();
    inputs.kept.request = request;
    start(
        JobStatus::Kind::solve,
        request.nearField ? "Estimating light and surfaces" : "Estimating with distant light only",
        [this, inputs](Progress& progress) -> Finish {
            const std::shared_ptr<const Estimate> estimate = runEstimate(inputs, progress);
            const Resources resources{progress.seconds(), peakMib(), availableThreads()};
            return [this, estimate, request = inputs.request, resources] {
                self.state.document.resources = resources;
                takeEstimate(request, estimate,
                             request.nearField ? "Estimate light and surfaces" : "Estimate with distant light only");
                self.log(LogLevel::info,
                         fmt::format("estimated in {:.1f} s, {:.0f} MiB", resources.seconds, resources.peakMib));
            };
        },
        [this, request, which, kept = inputs.kept](bool cancelled) {
            takeSnapshots(true);
            self.state.curves[which].running = false;
            // The best iterate is kept.
            if (cancelled && snapshot) takeEstimate(request, snapshot, "Estimate, stopped early");
            snapshot.reset();
            self.state.interrupted = readInterrupted(kept.record);
        });
}

std::shared_ptr<const Estimate> Editor::Impl::runEstimate(const EstimateInputs& in, Progress& progress) {
    progress.setBudget(in.request.budgetSeconds);
    PipelineOptions pipeline = pipelineOptionsOf(in.request);
    EstimateKeeper keeper(in.kept, fingerprintOf(*in.capture, pipeline), options.checkpointSeconds);
    const auto tell = [this](const std::function<void()>& what) {
        {
            std::lock_guard lock(solveMutex);
            what();
        }
        if (options.wake) options.wake();
    };
    SolveListener listener;
    listener.entry = [&](const TimelineEntry& entry) { tell([&] { newEntries.push_back(entry); }); };
    listener.snapshot = [&](Estimate estimate) {
        tell([&] { newSnapshot = std::make_shared<const Estimate>(std::move(estimate)); });
    };
    listener.snapshotFraction = 0.1;
    listener.checkpoint = [&](const SolveCheckpoint& checkpoint) {
        keeper.take(checkpoint);
        tell([&] { newPlan = checkpoint.plan; });
    };
    StageMeter meter(progress);
    const std::optional<SolveCheckpoint> earlier = in.goOn ? keeper.earlier() : std::nullopt;
    if (earlier) tell([&] { newEntries = earlier->timeline; });
    try {
        std::shared_ptr<const Capture> capture = in.capture;
        std::shared_ptr<const RadianceSamples> samples = in.samples;
        if (!pipeline.mirrorBalls.empty()) {
            // A ball is masked in its photograph, so what that shows of the mesh is looked up anew.
            auto masked = std::make_shared<Capture>(*capture);
            takeMirrorBalls(pipeline, *masked);
            capture = std::move(masked);
            samples.reset();
        }
        const Prepared prepared = prepare(*capture, pipeline, meter, progress, in.scene, samples);
        const SolveExtras extras{&listener, earlier ? &*earlier : nullptr,
                                 [&](const SolvePlan& plan) { tell([&] { newPlan = plan; }); }};
        auto estimate = std::make_shared<const Estimate>(
            solvePrepared(*capture, *in.scene, prepared, pipeline, meter, progress, extras));
        keeper.finished();
        return estimate;
    } catch (const Cancelled&) {
        keeper.stopped();
        throw;
    }
}

void Editor::Impl::takeEstimate(const SolveRequest& request, std::shared_ptr<const Estimate> estimate,
                                const std::string& label) {
    RunCurve& curve = self.state.curves[request.nearField ? 0 : 1];
    curve.running = false;
    curve.entries = estimate->timeline;
    if (!estimate->plan.stages.empty()) self.state.plan = estimate->plan;
    snapshot.reset();
    Version version = history.present();
    if (request.nearField) {
        version.look = lookThatFits(version.look, *estimate, self.state.document.scene->mesh.vertexCount());
        version.estimate = estimate;
        if (const fs::path file = std::exchange(self.state.environmentToCome, {}); !file.empty()) {
            version.look.environment.source = EnvironmentLook::Source::file;
            version.look.environment.file = file;
            remember(self.state.recentEnvironments, file);
        }
        solvedWith = request;
        self.state.document.quality = request.quality;
        self.state.document.seed = request.seed;
    } else {
        version.distantOnly = estimate;
    }
    history.push(label, std::move(version));
    dropThumbnails("env:recovered");
    std::erase_if(self.state.selection.emitters, [&](const std::string& id) { return !self.emitter(id); });
    self.state.panels.bottomFolded = true;
    if (request.nearField) {
        if (!std::exchange(shownOnce, true) && self.state.viewport.mode == ViewMode::photograph)
            self.state.viewport.mode = ViewMode::relit;
        saveUnsavedEstimate();
    }
}

std::optional<double> Editor::Impl::solveSecondsLeft() const {
    if (!planHeardAt) return {};
    double left = secondsLeft(self.state.plan, status->seconds - *planHeardAt);
    // The stage that runs has a say of its own: what is left of it is never nothing before it is over.
    if (status->fraction > 0.05 && status->fraction < 1)
        left = std::max(left, (status->seconds - stageSince) * (1 - status->fraction) / status->fraction);
    return solveBudget > 0 ? std::min(left, std::max(0.0, solveBudget - status->seconds)) : left;
}

bool Editor::Impl::viewportIsFree() {
    if (!snapshot) return true;
    if (relight.working()) return false;
    if (snapshotShown < snapshotTaken) snapshotShown = seconds();
    return seconds() - snapshotShown >= 3 * (snapshotShown - snapshotTaken);
}

void Editor::Impl::takeSnapshots(bool ended) {
    std::lock_guard lock(solveMutex);
    RunCurve& curve = self.state.curves[solveIsNearField ? 0 : 1];
    if (curve.running) curve.entries.insert(curve.entries.end(), newEntries.begin(), newEntries.end());
    newEntries.clear();
    if (newPlan) {
        self.state.plan = std::move(*newPlan);
        if (job) planHeardAt = job->progress().seconds();
    }
    newPlan.reset();
    if (!newSnapshot || !(ended || viewportIsFree())) return;
    snapshotTaken = seconds();
    if (job && status && status->kind == JobStatus::Kind::solve) {
        snapshot = newSnapshot;
        // The first answer is brought up, once: who then looks at the photographs again keeps them.
        if (!std::exchange(shownOnce, true) && self.state.viewport.mode == ViewMode::photograph)
            self.state.viewport.mode = ViewMode::relit;
    }
    newSnapshot.reset();
}

// ---- a light that no photograph shows

void Editor::findUnobservedLight() {
    const Document& document = state.document;
    if (!document.samples || impl_->job) return;
    state.unobservedSearch = {};
    impl_->start(
        JobStatus::Kind::search, "Finding an off-camera light",
        [impl = impl_.get(), capture = document.capture, scene = document.scene, samples = document.samples,
         folder = document.captureFolder, fix = document.fix, seed = state.solve.seed](Progress& progress) -> Finish {
            PipelineOptions options;
            options.solve.seed = seed;
            const UnobservedLightSearch search = searchUnobservedLight(*capture, options, progress, scene, samples);
            CaptureFix wanted = fix;
            for (const UnobservedLight& light : search.lights) wanted.proxies.push_back(proxyOf(light));
            return [impl, search, folder, wanted] {
                impl->self.state.unobservedSearch = {folder, search.words};
                if (!search.lights.empty()) impl->self.fixCapture(wanted, "Find off-camera light");
            };
        });
}

void Editor::removeProxy(size_t index) {
    CaptureFix fix = state.document.fix;
    if (index >= fix.proxies.size()) return;
    fix.proxies.erase(fix.proxies.begin() + std::ptrdiff_t(index));
    state.unobservedSearch = {};
    fixCapture(fix, "Remove off-camera light");
}

// ---- the capture read otherwise

namespace {

/// But for rounding: places of lights count from the capture's origin while it is open.
bool sameReading(CaptureFix a, CaptureFix b) {
    if (a.proxies.size() != b.proxies.size()) return false;
    for (size_t i = 0; i < a.proxies.size(); ++i)
        if (glm::length(a.proxies[i].centre - b.proxies[i].centre) <= 1e-9 * (1 + glm::length(b.proxies[i].centre)))
            a.proxies[i].centre = b.proxies[i].centre;
    return a == b;
}

/// Cameras and mesh stand where they stood: only what shines is another.
bool samePlaces(CaptureFix a, CaptureFix b) {
    for (CaptureFix* fix : {&a, &b}) {
        fix->proxies.clear();
        fix->states.clear();
        fix->environments.clear();
        fix->photometric = {};
        fix->smoothNormals = -1;
    }
    return a == b;
}

}  // namespace

std::shared_ptr<const CaptureInputs> CaptureInputs::of(const Document& d) {
    return std::make_shared<const CaptureInputs>(CaptureInputs{d.fix, d.capture, d.scene, d.samples, d.check});
}

void Editor::fixCapture(const CaptureFix& fix, const std::string& label) {
    if (impl_->job || !state.document.capture) return;
    const std::vector<HistoryEntry>& entries = history().entries();
    for (size_t i = history().index() + 1; i-- > 0;)
        if (sameReading(static_cast<const CaptureInputs*>(entries[i].version.inputs.get())->fix, fix)) {
            impl_->history.push(label, Version(entries[i].version));
            return impl_->followHistory();
        }
    impl_->readAgain(fix, label);
}

void Editor::Impl::goToEntry(size_t entry) {
    const std::vector<HistoryEntry>& entries = history.entries();
    if (entry < entries.size() && entries[entry].version.inputs != history.present().inputs && refusedWhileRunning())
        return;
    history.goTo(entry);
    followHistory();
    forgetLostLights();
}

void Editor::Impl::followHistory() {
    EditorState& ours = self.state;
    const auto* now = static_cast<const CaptureInputs*>(history.present().inputs.get());
    if (!now || now->scene == ours.document.scene) return;
    const CaptureInputs& inputs = *now;
    const bool moved = !samePlaces(inputs.fix, ours.document.fix);
    ours.document.fix = inputs.fix;
    ours.document.capture = inputs.capture;
    ours.document.scene = inputs.scene;
    ours.document.samples = inputs.samples;
    ours.document.check = inputs.check;
    tellEstimates();
    emittersOfEstimate.reset();
    emittersRevision = timedRevision = 0;
    playback = {};
    snapshot.reset();
    ours.interrupted.reset();
    ours.scope.reset();
    ours.probe.reset();
    ours.marking.reset();
    ours.selection.point.reset();
    ours.pointLight.reset();
    ours.viewport.hiddenComponents.clear();
    // Frames of the plate are matched to the capture as it is now.
    openPlates.clear();
    plateOpening.reset();
    dropThumbnails("view:");
    dropThumbnails("env:recovered");
    forgetLostLights();
    const bool solved = history.present().estimate || history.present().distantOnly;
    if (!solved) ours.viewport.mode = ViewMode::photograph;
    else if (ours.viewport.mode == ViewMode::photograph) ours.viewport.mode = ViewMode::relit;
    if (moved) frameScene();
}

void Editor::Impl::tellEstimates() {
    const Version& now = history.present();
    self.state.curves = {};
    if (now.distantOnly) self.state.curves[1].entries = now.distantOnly->timeline;
    if (now.estimate) self.state.curves[now.estimate->mode == "distant-only" ? 1 : 0].entries = now.estimate->timeline;
    self.state.plan = now.estimate ? now.estimate->plan : SolvePlan{};
}

void Editor::Impl::tellCheck() {
    if (!self.state.document.check) return;
    // Only what would spoil an estimate interrupts; the rest stands in the inspector and under File.
    const CaptureCheck& check = *self.state.document.check;
    if (check.lookBackwards || check.upAgreement < 0.3 || check.seenFraction < 0.3 || check.exposureSpreadStops > 0.5)
        self.state.panels.doctor = true;
    for (const std::string& warning : check.warnings) self.log(LogLevel::warning, warning);
}

}  // namespace relamp::ui
