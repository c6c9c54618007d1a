// Open, solve, save and export: what the editor does in the background. The worker gets its inputs by shared_ptr and
// gives back one step that the window's thread runs.
#include <cmath>
#include <nlohmann/json.hpp>

#include "base/is_there.h"
#include "base/parallel.h"
#include "capture/load_capture.h"
#include "capture/own_axes.h"
#include "clusters/emitter_clusters.h"
#include "editor_impl.h"
#include "image/image_io.h"
#include "pipeline/normals_choice.h"
#include "pipeline/pipeline.h"
#include "pipeline/plan.h"
#include "pipeline/working_mesh.h"
#include "radiance/gather.h"
#include "settings.h"
#include "shot/export_frame.h"
#include "shot/shot_leftovers.h"
#include "solve/unobserved/unobserved_light.h"
#include "thumbnails.h"

namespace relamp::ui {
namespace fs = std::filesystem;

namespace {

fs::path cleaned(const fs::path& path) {
    std::error_code failed;
    fs::path p = fs::absolute(path, failed).lexically_normal();
    if (failed) p = path.lexically_normal();
    if (p.filename().empty()) p = p.parent_path();
    return p;
}

bool isShot(const fs::path& path) { return isThere(path / "shot.json"); }

/// Everything that opening a capture computes once.
Document documentOf(Capture capture, const fs::path& folder, Progress& progress) {
    Document document;
    document.captureFolder = folder;
    const auto shared = std::make_shared<const Capture>(std::move(capture));
    document.scene = std::make_shared<const Scene>(buildScene(shared->mesh, progress, ownAxes(*shared)));
    document.capture = shared;
    bool images = !shared->views.empty();
    for (const View& view : shared->views) images = images && !view.image.pixels.empty();
    if (images) {
        document.check = std::make_shared<const CaptureCheck>(checkCapture(*shared, progress));
        document.samples =
            std::make_shared<const RadianceSamples>(gatherRadiance(*shared, *document.scene, {}, progress));
    }
    return document;
}

/// "desk-lamp-copy.relamp", or the first number that is free.
fs::path nameForCopy(const fs::path& shot) {
    for (int n = 1;; ++n) {
        const fs::path name = shot.parent_path() / fmt::format("{}-copy{}.relamp", shot.stem().string(),
                                                               n == 1 ? "" : fmt::format("-{}", n));
        if (!isThere(name)) return name;
    }
}

std::string whereFull(const std::exception& error) {
    if (dynamic_cast<const OutOfResources*>(&error))
        return "Free some space or choose another disk, then try again. Your edits are still here.";
    return "Your edits are still here.";
}

}  // namespace

fs::path Editor::Impl::documentPath() const {
    return self.state.document.shotFolder.empty() ? self.state.document.captureFolder : self.state.document.shotFolder;
}

void Editor::Impl::start(JobStatus::Kind kind, const std::string& title, std::function<Finish(Progress&)> work,
                         std::function<void(bool)> onEnd) {
    status = JobStatus{};
    status->kind = kind;
    status->title = title;
    onJobEnd = std::move(onEnd);
    jobStart = Clock::now();
    expectedSeconds = 0;
    job = std::make_unique<Job<Finish>>(std::move(work), options.wake);
}

const std::optional<JobStatus>& Editor::job() const { return impl_->status; }

void Editor::cancelJob() {
    if (!impl_->job) return;
    impl_->status->stopping = true;
    impl_->job->progress().requestStop();
}

void Editor::pauseJob(bool paused) {
    if (!impl_->job) return;
    impl_->job->progress().setPaused(paused);
    impl_->status->paused = paused;
}

void Editor::Impl::pollJob() {
    if (!job) return;
    Progress& progress = job->progress();
    status->stage = progress.label();
    status->fraction = progress.fraction();
    status->seconds = progress.seconds();
    if (expectedSeconds > 0) status->secondsLeft = std::max(0.0, expectedSeconds - status->seconds);
    if (!job->done()) return;
    const std::unique_ptr<Job<Finish>> finished = std::move(job);
    const JobStatus was = *status;
    status.reset();
    const std::function<void(bool)> ended = std::exchange(onJobEnd, {});
    try {
        finished->take()();
        return;
    } catch (const Cancelled&) {
        if (ended) ended(true);
        self.log(LogLevel::info, was.title + ": stopped");
        return;
    } catch (const std::bad_alloc&) {
        self.fail(was.title + " ran out of memory", "There is not enough memory for this.",
                  "Close other programs, or use a smaller mesh or fewer photographs.");
    } catch (const std::exception& error) {
        const bool opening = was.kind == JobStatus::Kind::open;
        self.fail(opening ? "This could not be opened" : was.title + " failed", error.what(),
                  opening ? "What was open before is still here." : whereFull(error));
    }
    if (ended) ended(false);
}

// ---- open

void Editor::open(const fs::path& path) {
    // An environment image becomes the look's environment.
    std::error_code error;
    if (fs::is_regular_file(path, error) && path.filename() != "transforms.json" && path.filename() != "shot.json" &&
        path.extension() != ".relamp") {
        if (!estimate()) {
            fail("Open a capture first",
                 path.filename().string() +
                     " is a file. A capture is a folder with transforms.json, photographs and a mesh.",
                 "Drop the capture's folder here; an image dropped afterwards becomes its environment.");
            return;
        }
        const fs::path file = cleaned(path);
        edit("Environment " + file.filename().string(), [&](Look& look) {
            look.environment.source = EnvironmentLook::Source::file;
            look.environment.file = file;
        });
        remember(state.recentEnvironments, file);
        return;
    }
    if (unsavedChanges()) state.unsaved = UnsavedQuestion{UnsavedQuestion::Then::open, path};
    else openNow(path);
}

void Editor::openNow(const fs::path& given) {
    fs::path path = cleaned(given);
    if (path.filename() == "transforms.json" || path.filename() == "shot.json") path = path.parent_path();
    if (impl_->job) {
        fail("Something else is running", impl_->status->title + " is not finished.",
             "Wait for it, or stop it in the status bar.");
        return;
    }
    mendShot(path);
    if (!isThere(path)) {
        fail("This could not be opened", path.string() + " does not exist.", "It may have been moved or renamed.");
        std::erase(state.recent, path);
        return;
    }
    if (!isShot(path)) return impl_->openCapture(path);
    if (const auto lock = impl_->lockFor(path); !lock->owner().empty())
        state.locked = LockedQuestion{path, lock->owner()};
    else impl_->openShotFolder(path);
}

std::shared_ptr<ShotLock> Editor::Impl::lockFor(const fs::path& shot) const {
    std::error_code failed;
    if (shotLock && shotLock->held() && fs::weakly_canonical(shot, failed) == shotLock->shot()) return shotLock;
    return std::make_shared<ShotLock>(ShotLock::take(shot));
}

void Editor::answerLocked(LockedAnswer answer) {
    if (!state.locked) return;
    const fs::path path = state.locked->path;
    state.locked.reset();
    if (answer == LockedAnswer::cancel || impl_->job) return;
    impl_->openShotFolder(path, {}, answer == LockedAnswer::copy ? Impl::OpenAs::copy : Impl::OpenAs::readOnly);
}

void Editor::Impl::setDocument(Document document, Version version, const std::string& label) {
    EditorState& ours = self.state;
    const bool solved = version.estimate || version.distantOnly;
    ours.curves = {};
    if (version.estimate)
        ours.curves[version.estimate->mode == "distant-only" ? 1 : 0].entries = version.estimate->timeline;
    ours.plan = version.estimate ? version.estimate->plan : SolvePlan{};
    ours.solve.quality = document.quality;
    ours.solve.seed = document.seed;
    solvedWith.reset();
    if (solved) solvedWith = ours.solve;
    history = History(std::move(version), label);
    history.markSaved();
    emittersOfEstimate.reset();
    emittersRevision = 0;
    snapshot.reset();
    ours.document = std::move(document);
    ours.selection = {};
    ours.pointLight.reset();
    ours.viewport.solo.clear();
    ours.viewport.hiddenComponents.clear();
    ours.viewport.throughView = false;
    ours.viewport.mode = solved ? ViewMode::relit : ViewMode::photograph;
    autosave.clear();
    autosavedEstimate.reset();
    failedEstimate.reset();
    savedEstimate = ours.document.shotFolder.empty() ? nullptr : history.present().estimate;
    autosavedRevision = history.revision();
    shotLock.reset();
    if (restored) Autosave::discard(*restored);
    restored.reset();
    dropThumbnails("view:");
    dropThumbnails("env:recovered");
    const Scene& scene = *ours.document.scene;
    Vec3 low(1e30f), high(-1e30f);
    for (size_t v = 0; v < scene.mesh.vertexCount(); ++v)
        if (scene.referenced[v]) {
            low = glm::min(low, scene.mesh.positions[v]);
            high = glm::max(high, scene.mesh.positions[v]);
        }
    if (scene.diagonal > 0) {
        // From where the first photograph was taken: the artist knows that side.
        ours.viewport.camera.frame(0.5f * (low + high), 0.5f * scene.diagonal);
        if (!ours.document.capture->views.empty()) {
            const Camera& camera = ours.document.capture->views[0].camera;
            const float distance = glm::dot(Vec3(camera.forward()), 0.5f * (low + high) - Vec3(camera.position()));
            ours.viewport.camera.matchCamera(camera, std::max(distance, 0.05f * scene.diagonal));
        }
    }
    remember(ours.recent, documentPath());
    if (ours.document.check && !solved) {
        // Only what would spoil an estimate interrupts; the rest stands in the inspector and under File.
        const CaptureCheck& check = *ours.document.check;
        if (check.lookBackwards || check.upAgreement < 0.3 || check.seenFraction < 0.3 ||
            check.exposureSpreadStops > 0.5)
            ours.panels.doctor = true;
        for (const std::string& warning : check.warnings) self.log(LogLevel::warning, warning);
    }
    self.log(LogLevel::info, fmt::format("{}: {} views, {} vertices", documentPath().string(),
                                         ours.document.capture->views.size(), scene.mesh.vertexCount()));
}

void Editor::fixCapture(const CaptureFix& fix) {
    if (!impl_->job && state.document.capture) impl_->openCapture(state.document.captureFolder, fix);
}

void Editor::Impl::openCapture(const fs::path& folder, const CaptureFix& fix, std::optional<FoundWork> recovered) {
    start(JobStatus::Kind::open, "Opening " + folder.filename().string(),
          [this, folder, fix, recovered](Progress& progress) -> Finish {
              LoadOptions load;
              load.fix = fix;
              auto document =
                  std::make_shared<Document>(documentOf(loadCapture(folder, load, progress), folder, progress));
              document->fix = fix;
              if (fix.photometric.empty() && document->samples) {
                  progress.begin("Do exposures differ?", 1);
                  const Prepared seen{{}, document->scene, document->samples, {}};
                  load.fix.photometric = choosePhotometric(*document->capture, seen, progress);
                  if (!load.fix.photometric.empty()) {
                      *document = documentOf(loadCapture(folder, load, progress), folder, progress);
                      document->fix = load.fix;
                  }
              }
              if (fix.smoothNormals < 0 && document->capture->mesh.triangles.size() <= largestWorkingMesh &&
                  normalsLookNoisy(*document->scene)) {
                  progress.begin("Are the mesh's normals good enough?", 1);
                  const EmitterClusters clusters =
                      clusterEmitters(*document->scene, *document->capture, *document->samples, {}, progress);
                  if (const NormalsChoice choice =
                          chooseNormals(*document->scene, *document->samples, clusters, {}, progress);
                      choice.rounds > 0) {
                      load.fix.smoothNormals = choice.rounds;
                      *document = documentOf(loadCapture(folder, load, progress), folder, progress);
                      document->fix = load.fix;
                  }
              }
              return [this, document, recovered] {
                  setDocument(std::move(*document), {}, "Opened");
                  // Edits without the estimate they were made on: they come back with the next one.
                  if (recovered) showRecovered(*recovered, {});
              };
          });
}

void Editor::Impl::showRecovered(const FoundWork& found, Version saved) {
    // It counts as unsaved until the user saves it, and stays where it was found until our own autosave holds it.
    Version work = saved;
    saved.estimate.reset();
    history = History(std::move(saved), "Last saved");
    history.markSaved();
    const auto take = [&](const std::string& label, const Look& look) {
        work.look =
            work.estimate ? lookThatFits(look, *work.estimate, self.state.document.scene->mesh.vertexCount()) : look;
        history.push(label, work);
    };
    for (size_t i = 0; i < found.work.steps.size(); ++i)
        if (const AutosavedStep& step = found.work.steps[i];
            i + 1 < found.work.steps.size() || !(step.look == found.work.look))
            take(step.label, step.look);
    take("Recovered work", found.work.look);
    restored = found;
    autosavedRevision = 0;
    lastAutosave = -1e9;
}

void Editor::Impl::openShotFolder(const fs::path& folder, std::optional<FoundWork> recovered, OpenAs as) {
    start(JobStatus::Kind::open, "Opening " + folder.filename().string(),
          [this, folder, recovered, as](Progress& progress) -> Finish {
              std::string trouble;
              const auto shot = std::make_shared<Shot>();
              try {
                  *shot = openShot(folder, true, progress);
              } catch (const Error& error) {
                  // Without its photographs a shot can still be relit.
                  trouble = error.what();
                  *shot = openShot(folder, false, progress);
              }
              fs::path place = recovered ? recovered->work.shotFolder : folder;
              if (as == OpenAs::copy) {
                  place = nameForCopy(folder);
                  saveShot(*shot, shot->capture.mesh, place, false);
              }
              auto document = std::make_shared<Document>(documentOf(shot->capture, shot->captureFolder, progress));
              document->shotFolder = place;
              document->fix = shot->fix;
              document->quality = shot->quality;
              document->seed = shot->seed;
              document->resources = shot->resources;
              return [this, folder, document, shot, trouble, recovered, as] {
                  const fs::path saved = document->shotFolder;
                  const std::shared_ptr<ShotLock> mine =
                      saved.empty() || as == OpenAs::readOnly ? nullptr : lockFor(saved);
                  document->readOnly = as == OpenAs::readOnly || (mine && !mine->owner().empty());
                  Version version;
                  version.look = shot->look;
                  version.estimate = std::make_shared<const Estimate>(std::move(shot->estimate));
                  const bool readOnly = document->readOnly;
                  setDocument(std::move(*document), version, "Opened");
                  if (mine && mine->held()) shotLock = mine;
                  if (!trouble.empty())
                      self.fail("The photographs could not be opened", trouble,
                                "The shot can be relit and exported. To estimate again, put the photographs back and "
                                "open it again.");
                  if (readOnly && as == OpenAs::usual)
                      self.fail("This shot is open elsewhere", saved.string() + " is open: " + mine->owner() + ".",
                                "It was opened read-only: saving asks for another place.");
                  if (!recovered) return;
                  if (folder != saved) savedEstimate.reset();
                  showRecovered(*recovered, version);
              };
          });
}

// ---- save

void Editor::save() {
    if (!state.document.capture) return;
    if (state.document.shotFolder.empty() || state.document.readOnly) state.panels.saveBrowser = true;
    else impl_->saveTo(state.document.shotFolder);
}

void Editor::saveAs(const fs::path& given) {
    fs::path folder = cleaned(given);
    if (folder.extension() != ".relamp") folder += ".relamp";
    impl_->saveTo(folder);
}

void Editor::Impl::saveTo(const fs::path& folder) {
    if (saving) {
        saveNext = folder;
        return;
    }
    const Version version = history.present();
    const std::shared_ptr<const Estimate> estimate = version.estimate ? version.estimate : version.distantOnly;
    if (!estimate) {
        self.fail("There is nothing to save yet",
                  "A shot holds what was found about the light, and nothing was estimated yet.",
                  "Press Ctrl+Enter to estimate, then save.");
        whenSaved = {};
        return;
    }
    const std::shared_ptr<ShotLock> mine = lockFor(folder);
    if (!mine->owner().empty()) {
        self.fail("This shot is open elsewhere", folder.string() + " is open: " + mine->owner() + ".",
                  "Close it there, or save under another name with Ctrl+Shift+S. Your edits are still here.");
        whenSaved = {};
        return;
    }
    const Document document = self.state.document;
    const size_t entry = history.index();
    const uint64_t revision = history.revision();
    saving = std::make_unique<Job<Finish>>(
        [this, version, estimate, document, folder, entry, revision, mine](Progress&) -> Finish {
            Shot shot;
            shot.captureFolder = document.captureFolder;
            shot.fix = document.fix;
            if (document.capture) shot.capture.origin = document.capture->origin;
            shot.estimate = *estimate;
            shot.look = version.look;
            shot.quality = document.quality;
            shot.seed = document.seed;
            shot.resources = document.resources;
            saveShot(shot, document.scene->mesh, folder, true);
            return [this, folder, entry, revision, mine, estimate] {
                self.state.document.shotFolder = folder;
                self.state.document.readOnly = false;
                shotLock = mine->held() ? mine : nullptr;
                savedEstimate = estimate;
                // Edits made while it was written are still unsaved.
                if (history.index() == entry && history.revision() == revision) {
                    history.markSaved();
                    autosave.clear();
                    autosavedEstimate.reset();
                    if (restored) Autosave::discard(*restored);
                    restored.reset();
                }
                remember(self.state.recent, folder);
                self.log(LogLevel::info, folder.string() + ": saved");
                if (const std::function<void()> next = std::exchange(whenSaved, {})) next();
            };
        },
        options.wake);
}

void Editor::Impl::pollSaving() {
    if (!saving || !saving->done()) return;
    const std::unique_ptr<Job<Finish>> finished = std::move(saving);
    try {
        finished->take()();
    } catch (const Cancelled&) {
    } catch (const std::exception& error) {
        whenSaved = {};
        self.fail("The shot could not be saved", error.what(), whereFull(error));
    }
    if (!saving && !saveNext.empty()) saveTo(std::exchange(saveNext, {}));
}

void Editor::Impl::saveUnsavedEstimate() {
    const Version version = history.present();
    if (saving || !autosave.working() || !version.estimate) return;
    lastEstimateTry = seconds();
    saving = std::make_unique<Job<Finish>>(
        [this, version, document = self.state.document,
         folder = autosave.estimateFolder(++estimateNumber)](Progress&) -> Finish {
            Shot shot;
            shot.captureFolder = document.captureFolder;
            shot.fix = document.fix;
            if (document.capture) shot.capture.origin = document.capture->origin;
            shot.estimate = *version.estimate;
            shot.look = version.look;
            shot.quality = document.quality;
            shot.seed = document.seed;
            shot.resources = document.resources;
            try {
                saveShot(shot, document.scene->mesh, folder, true);
            } catch (const Error& error) {
                return [this, estimate = version.estimate, text = std::string(error.what())] {
                    if (std::exchange(failedEstimate, estimate) != estimate)
                        self.fail("The estimate could not be saved by itself", text,
                                  "Free some space, or save the shot to another disk with Ctrl+Shift+S.");
                };
            }
            return [this, estimate = version.estimate, folder] {
                failedEstimate.reset();
                // By now it may be of no use any more: something else was opened, or it was saved.
                if (estimate == history.present().estimate && estimate != savedEstimate && self.unsavedChanges()) {
                    autosavedEstimate = estimate;
                    autosavedFolder = folder;
                    writeAutosave();
                } else {
                    std::error_code ignored;
                    fs::remove_all(folder, ignored);
                }
            };
        },
        options.wake);
}

void Editor::requestQuit() {
    if (unsavedChanges()) state.unsaved = UnsavedQuestion{UnsavedQuestion::Then::quit, {}};
    else impl_->quit = true;
}

bool Editor::quitting() const { return impl_->quit; }

void Editor::answerUnsaved(bool saveFirst, bool proceed) {
    if (!state.unsaved) return;
    const UnsavedQuestion question = *state.unsaved;
    state.unsaved.reset();
    if (!proceed) return;
    const auto next = [this, question] {
        if (question.then == UnsavedQuestion::Then::open) openNow(question.path);
        else impl_->quit = true;
    };
    if (!saveFirst) return next();
    impl_->whenSaved = next;
    save();
}

// ---- solve

bool Editor::stale() const {
    if (!impl_->solvedWith || !estimate()) return false;
    const SolveRequest &a = *impl_->solvedWith, &b = state.solve;
    return a.quality != b.quality || a.seed != b.seed || a.gauge.kind != b.gauge.kind ||
           a.gauge.albedo != b.gauge.albedo || a.gauge.whiteAlbedo != b.gauge.whiteAlbedo ||
           a.gauge.emitter != b.gauge.emitter || a.gauge.radiance != b.gauge.radiance || a.gauge.view != b.gauge.view ||
           a.gauge.pixel != b.gauge.pixel || a.palette != b.palette || a.lightSmoothness != b.lightSmoothness ||
           a.albedoSmoothness != b.albedoSmoothness;
}

void Editor::solve(const SolveRequest& request) {
    const Document& document = state.document;
    if (!document.capture) return;
    if (!document.samples) {
        fail("The photographs are missing", "Estimating needs the capture's photographs, and they could not be read.",
             "Put them back and open the capture again.");
        return;
    }
    if (impl_->job) {
        fail("Something else is running", impl_->status->title + " is not finished.",
             "Wait for it, or stop it in the status bar.");
        return;
    }
    autosave();
    const size_t which = request.nearField ? 0 : 1;
    state.curves[which] = {};
    state.curves[which].running = true;
    impl_->solveIsNearField = request.nearField;
    {
        std::lock_guard lock(impl_->solveMutex);
        impl_->newEntries.clear();
        impl_->newSnapshot.reset();
        impl_->newPlan.reset();
    }
    Impl* impl = impl_.get();
    const auto apply = [impl, request, which](std::shared_ptr<const Estimate> estimate, const std::string& label) {
        Editor& self = impl->self;
        self.state.curves[which].running = false;
        self.state.curves[which].entries = estimate->timeline;
        if (!estimate->plan.stages.empty()) self.state.plan = estimate->plan;
        impl->snapshot.reset();
        Version version = impl->history.present();
        if (request.nearField) {
            version.look = lookThatFits(version.look, *estimate, self.state.document.scene->mesh.vertexCount());
            version.estimate = estimate;
            impl->solvedWith = request;
            self.state.document.quality = request.quality;
            self.state.document.seed = request.seed;
        } else {
            version.distantOnly = estimate;
        }
        impl->history.push(label, std::move(version));
        dropThumbnails("env:recovered");
        std::erase_if(self.state.selection.emitters, [&](const std::string& id) { return !self.emitter(id); });
        if (request.nearField) {
            if (self.state.viewport.mode == ViewMode::photograph) self.state.viewport.mode = ViewMode::relit;
            impl->saveUnsavedEstimate();
        }
    };
    impl_->start(
        JobStatus::Kind::solve,
        request.nearField ? "Estimating light and surfaces" : "Estimating with distant light only",
        [impl, request, apply, capture = document.capture, scene = document.scene,
         samples = document.samples](Progress& progress) -> Finish {
            progress.setBudget(request.budgetSeconds);
            PipelineOptions options;
            options.solve = solveOptionsFor(request.quality);
            options.solve.nearField = request.nearField;
            options.solve.gauge = request.gauge;
            options.solve.seed = request.seed;
            options.solve.palette = size_t(std::max(0, request.palette));
            options.solve.lightSmoothness = request.lightSmoothness;
            options.solve.albedoSmoothness = request.albedoSmoothness;
            SolveListener listener;
            listener.entry = [impl](const TimelineEntry& entry) {
                {
                    std::lock_guard lock(impl->solveMutex);
                    impl->newEntries.push_back(entry);
                }
                if (impl->options.wake) impl->options.wake();
            };
            listener.snapshot = [impl](Estimate estimate) {
                {
                    std::lock_guard lock(impl->solveMutex);
                    impl->newSnapshot = std::make_shared<const Estimate>(std::move(estimate));
                }
                if (impl->options.wake) impl->options.wake();
            };
            const auto planned = [impl](const SolvePlan& plan) {
                {
                    std::lock_guard lock(impl->solveMutex);
                    impl->newPlan = plan;
                }
                if (impl->options.wake) impl->options.wake();
            };
            StageMeter meter(progress);
            const Prepared prepared = prepare(*capture, options, meter, progress, scene, samples);
            const auto estimate = std::make_shared<const Estimate>(
                solvePrepared(*capture, *scene, prepared, options, meter, progress, &listener, nullptr, planned));
            const Resources resources{progress.seconds(), peakMib(), availableThreads()};
            return [impl, apply, estimate, request, resources] {
                impl->self.state.document.resources = resources;
                apply(estimate, request.nearField ? "Estimate light and surfaces" : "Estimate with distant light only");
                impl->self.log(LogLevel::info,
                               fmt::format("estimated in {:.1f} s, {:.0f} MiB", resources.seconds, resources.peakMib));
            };
        },
        [impl, apply, which](bool cancelled) {
            impl->takeSnapshots();
            impl->self.state.curves[which].running = false;
            // The best iterate is kept.
            if (cancelled && impl->snapshot) apply(impl->snapshot, "Estimate, stopped early");
            impl->snapshot.reset();
        });
    // Measured: 0.45 ms a vertex at standard quality on two cores; a poor guess is better than none, and it is marked
    // as about.
    const double rate = request.quality == "draft" ? 0.2e-3 : request.quality == "fine" ? 1.2e-3 : 0.45e-3;
    impl_->expectedSeconds = rate * double(document.scene->mesh.vertexCount()) * 2 / std::max(1, availableThreads());
    if (request.budgetSeconds > 0) impl_->expectedSeconds = std::min(impl_->expectedSeconds, request.budgetSeconds);
}

void Editor::findUnobservedLight() {
    const Document& document = state.document;
    if (!document.samples || impl_->job) return;
    state.unobservedSearch = {};
    impl_->start(
        JobStatus::Kind::search, "Looking for an unobserved light",
        [impl = impl_.get(), capture = document.capture, scene = document.scene, samples = document.samples,
         folder = document.captureFolder, fix = document.fix, seed = state.solve.seed](Progress& progress) -> Finish {
            const std::optional<DecimatedMesh> working = workingMesh(*capture, {}, progress);
            const auto searched =
                working ? std::make_shared<const Scene>(buildScene(working->mesh, progress, ownAxes(*capture))) : scene;
            const auto seen =
                working ? std::make_shared<const RadianceSamples>(gatherRadiance(*capture, *searched, {}, progress))
                        : samples;
            const EmitterClusters clusters = clusterEmitters(*searched, *capture, *seen, {}, progress);
            UnobservedLightOptions options;
            options.seed = seed;
            const UnobservedLightSearch search =
                relamp::findUnobservedLight(*capture, *searched, *seen, clusters, options, progress);
            CaptureFix wanted = fix;
            if (search.light) wanted.proxies.push_back(proxyOf(*search.light));
            return [impl, search, folder, wanted] {
                impl->self.state.unobservedSearch = {folder, search.words};
                impl->self.log(LogLevel::info, search.words);
                if (search.light) impl->self.fixCapture(wanted);
            };
        });
}

void Editor::removeProxy(size_t index) {
    CaptureFix fix = state.document.fix;
    if (index >= fix.proxies.size()) return;
    fix.proxies.erase(fix.proxies.begin() + std::ptrdiff_t(index));
    state.unobservedSearch = {};
    fixCapture(fix);
}

void Editor::Impl::takeSnapshots() {
    std::lock_guard lock(solveMutex);
    RunCurve& curve = self.state.curves[solveIsNearField ? 0 : 1];
    if (curve.running) curve.entries.insert(curve.entries.end(), newEntries.begin(), newEntries.end());
    newEntries.clear();
    if (newPlan) self.state.plan = std::move(*newPlan);
    newPlan.reset();
    if (!newSnapshot) return;
    if (job && status && status->kind == JobStatus::Kind::solve) snapshot = newSnapshot;
    newSnapshot.reset();
}

// ---- export

void Editor::exportFrames(const ExportRequest& request) {
    const std::shared_ptr<const Estimate> estimate = this->estimate();
    if (!estimate || !state.document.scene) {
        fail("There is nothing to export yet", "Frames are rendered from what was found about the light.",
             "Press Ctrl+Enter to estimate first.");
        return;
    }
    if (impl_->job) {
        fail("Something else is running", impl_->status->title + " is not finished.",
             "Wait for it, or stop it in the status bar.");
        return;
    }
    std::vector<FrameJob> jobs;
    try {
        checkLayers(request.layers);
        const std::string size =
            request.width > 0 && request.height > 0 ? fmt::format("{}x{}", request.width, request.height) : "";
        if (request.file.empty()) throw Error("no file name was given");
        using Views = ExportRequest::Views;
        if (request.views == Views::present) {
            FrameJob one;
            one.camera = impl_->eye;
            if (request.width > 0 && request.height > 0) {
                const double factor = double(request.height) / std::max(1, one.camera.height);
                one.camera.focalX *= factor;
                one.camera.focalY *= factor;
                one.camera.centreX = request.width / 2.0 + (one.camera.centreX - one.camera.width / 2.0) * factor;
                one.camera.centreY *= factor;
                one.camera.width = request.width;
                one.camera.height = request.height;
            }
            one.file = request.file;
            jobs.push_back(one);
        } else if (request.views == Views::capture) {
            jobs = frameJobs(*state.document.capture, std::to_string(state.selection.view), "", size, request.file);
        } else {
            jobs = frameJobs(*state.document.capture, "all", request.views == Views::range ? request.range : "", size,
                             request.file);
        }
    } catch (const Error& error) {
        fail("The export could not start", error.what(), "Change it in the export window and try again.");
        state.panels.exportFrames = true;
        return;
    }
    Impl* impl = impl_.get();
    const Look look = lookThatFits(this->look(), *estimate, state.document.scene->mesh.vertexCount());
    impl_->start(
        JobStatus::Kind::exportFrames,
        jobs.size() == 1 ? "Rendering a frame" : fmt::format("Rendering {} frames", jobs.size()),
        [impl, jobs, look, estimate, request, scene = state.document.scene,
         origin = state.document.capture ? state.document.capture->origin : DVec3(0)](Progress& progress) -> Finish {
            const RelitScene relit = applyLook(*scene, *estimate, look, progress);
            FrameOptions options;
            options.samplesPerPixel = request.samples;
            std::vector<std::string> failures;
            size_t written = 0;
            for (const FrameJob& one : jobs) {
                try {
                    const Frame frame = renderFrame(relit, one.camera, options, progress);
                    writeFrame(one.file, frame, relit, one.camera, request.layers, origin);
                    ++written;
                    logInfo("{}: written ({} of {})", one.file.string(), written, jobs.size());
                } catch (const OutOfResources& error) {
                    // The others would not fit either.
                    failures.insert(failures.begin(), error.what());
                    break;
                } catch (const Error& error) { failures.push_back(error.what()); }
            }
            return [impl, failures, written, all = jobs.size()] {
                if (failures.empty()) return;
                impl->self.fail(
                    fmt::format("{} frame(s) could not be written", all - written), failures.front(),
                    fmt::format(
                        "{} frame(s) were written. Free space or choose another folder, then export the others again.",
                        written));
            };
        });
}

}  // namespace relamp::ui
