// Opening: a capture, a shot, an environment image.
#include "base/is_there.h"
#include "capture/capture_formats.h"
#include "capture/own_axes.h"
#include "edit/look_keys.h"
#include "editor_impl.h"
#include "interrupted.h"
#include "pipeline/pipeline.h"
#include "pipeline/shot_of.h"
#include "settings.h"
#include "shot/shot_leftovers.h"
#include "thumbnails.h"

namespace relamp::ui {
namespace fs = std::filesystem;

namespace {

bool isShot(const fs::path& path) { return isThere(path / "shot.json"); }

bool hasImages(const Capture& capture) {
    return !capture.views.empty() && std::all_of(capture.views.begin(), capture.views.end(),
                                                 [](const View& view) { return !view.image.pixels.empty(); });
}

/// What opening a capture computes once.
Document documentOf(Capture capture, const fs::path& folder, Progress& progress) {
    Document document;
    document.captureFolder = folder;
    document.capture = std::make_shared<const Capture>(std::move(capture));
    document.scene =
        std::make_shared<const Scene>(buildScene(document.capture->mesh, progress, ownAxes(*document.capture)));
    if (hasImages(*document.capture)) {
        document.check = std::make_shared<const CaptureCheck>(checkCapture(*document.capture, progress));
        document.samples =
            std::make_shared<const RadianceSamples>(gatherRadiance(*document.capture, *document.scene, {}, progress));
    }
    return document;
}

/// A capture read as `fix` says, with exposures and normals put right as a solve on the command line does.
Document correctedDocument(const fs::path& folder, const CaptureFix& fix, Progress& progress) {
    PipelineOptions options;
    options.load.fix = fix;
    Capture capture = loadCapture(folder, options.load, progress);
    Document document;
    if (hasImages(capture)) {
        StageMeter meter(progress);
        Prepared prepared = prepare(capture, options, meter, progress);
        const Corrections done = correctCapture(options, capture, prepared, meter, progress);
        meter.end();
        document.captureFolder = folder;
        document.capture = std::make_shared<const Capture>(std::move(capture));
        document.check = std::make_shared<const CaptureCheck>(checkCapture(*document.capture, progress));
        if (prepared.working) {
            // What is shown is the capture's own mesh.
            document.scene =
                std::make_shared<const Scene>(buildScene(document.capture->mesh, progress, ownAxes(*document.capture)));
            document.samples = std::make_shared<const RadianceSamples>(
                gatherRadiance(*document.capture, *document.scene, options.gather, progress));
        } else {
            document.scene = prepared.scene;
            document.samples = prepared.samples;
        }
        document.fix = fix;
        document.fix.registration = done.registration;
        document.fix.photometric = done.photometric;
        document.fix.mend = done.mend;
        document.fix.proxies = fixOf(*document.capture, done, fix).proxies;
        if (done.smoothedNormals > 0) document.fix.smoothNormals = done.smoothedNormals;
    } else {
        document = documentOf(std::move(capture), folder, progress);
        document.fix = fix;
    }
    return document;
}

/// "room-copy.relamp", or the first number that is free.
fs::path nameForCopy(const fs::path& shot) {
    for (int n = 1;; ++n) {
        fs::path name = shot.parent_path() /
                        fmt::format("{}-copy{}.relamp", shot.stem().string(), n == 1 ? "" : fmt::format("-{}", n));
        if (!isThere(name)) return name;
    }
}

}  // namespace

void Editor::open(const fs::path& given) {
    const fs::path path = captureFolderOf(given);
    // An environment image becomes the look's environment.
    std::error_code error;
    if (fs::is_regular_file(path, error) && path.filename() != "shot.json" && path.extension() != ".relamp") {
        if (!estimate() && state.document.capture && (path.extension() == ".exr" || path.extension() == ".hdr")) {
            state.panorama = PanoramaQuestion{cleaned(path)};
            return;
        }
        if (!estimate()) {
            fail("Open a capture first",
                 fmt::format("{} is a file. A capture is a folder with {}, photographs and a mesh.",
                             path.filename().string(), captureMarks()),
                 "Drop the capture's folder here; an image dropped afterwards becomes its environment.");
            return;
        }
        openEnvironment(path);
        return;
    }
    if (unsavedChanges()) state.unsaved = UnsavedQuestion{UnsavedQuestion::Then::open, path};
    else openNow(path);
}

void Editor::openEnvironment(const fs::path& given) {
    const std::shared_ptr<const Estimate> estimate = this->estimate();
    if (!estimate) return;
    const fs::path file = cleaned(given);
    readInBackground(
        file,
        [estimate, file] {
            EnvironmentLook wanted;
            wanted.source = EnvironmentLook::Source::file;
            wanted.file = file;
            distantOfLook(*estimate, wanted);
        },
        [file](Editor& editor) {
            editor.edit("Environment " + file.filename().string(), [&](Look& look) {
                look.environment.source = EnvironmentLook::Source::file;
                look.environment.file = file;
            });
            remember(editor.state.recentEnvironments, file);
        });
}

void Editor::addLightProbe(const fs::path& given) {
    const fs::path file = cleaned(given);
    readInBackground(
        file, [file] { readLightProbe(file); },
        [file](Editor& editor) {
            std::vector<fs::path>& probes = editor.state.solve.lightProbes;
            if (std::find(probes.begin(), probes.end(), file) == probes.end()) probes.push_back(file);
            editor.say(file.filename().string() + " is a light reference of the next estimate");
        });
}

void Editor::answerPanorama(PanoramaUse use) {
    if (!state.panorama) return;
    const fs::path file = std::exchange(state.panorama, {})->file;
    if (use == PanoramaUse::lightReference) addLightProbe(file);
    if (use != PanoramaUse::environment) return;
    if (estimate()) return openEnvironment(file);  // one came while this was asked
    readInBackground(
        file, [file] { readImage(file); },
        [file](Editor& editor) {
            if (editor.estimate()) return editor.openEnvironment(file);
            editor.state.environmentToCome = file;
            editor.say(file.filename().string() + " becomes the environment with the first estimate");
        });
}

void Editor::readInBackground(const fs::path& file, const std::function<void()>& read,
                              const std::function<void(Editor&)>& done) {
    if (impl_->refusedWhileRunning()) return;
    impl_->start(JobStatus::Kind::open, "Reading " + file.filename().string(),
                 [impl = impl_.get(), read, done](Progress& progress) -> Finish {
                     progress.begin("Reading the file", 1);
                     read();
                     return [impl, done] { done(impl->self); };
                 });
}

void Editor::openNow(const fs::path& given) {
    fs::path path = captureFolderOf(cleaned(given));
    if (path.filename() == "shot.json") path = path.parent_path();
    if (impl_->refusedWhileRunning()) return;
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
    ours.solve.quality = document.quality;
    ours.solve.seed = document.seed;
    if (ours.document.captureFolder != document.captureFolder) {
        ours.solve.lightProbes.clear();
        ours.solve.marks.clear();
    }
    solvedWith.reset();
    if (solved) solvedWith = ours.solve;
    version.inputs = CaptureInputs::of(document);
    history = History(std::move(version), label);
    history.markSaved();
    tellEstimates();
    emittersOfEstimate.reset();
    emittersRevision = timedRevision = 0;
    playback = {};
    ours.time = {};
    if (const std::vector<int> keys = keyFrames(history.present().look); !keys.empty()) {
        ours.time.first = std::min(1, keys.front());
        ours.time.last = std::max(ours.time.last, keys.back());
        ours.time.frame = keys.front();
    }
    ours.environmentToCome.clear();
    ours.panorama.reset();
    snapshot.reset();
    ours.scope.reset();
    ours.probe.reset();
    ours.document = std::move(document);
    ours.selection = {};
    ours.pointLight.reset();
    ours.viewport.solo.clear();
    ours.viewport.hiddenComponents.clear();
    ours.viewport.region.reset();
    ours.panels.bottomFolded = true;
    ours.viewport.compareWith = -1;
    ours.snapshots = {};
    changesBeside = savedBeside = 0;
    ours.viewport.throughView = ours.viewport.throughPlate = false;
    ours.plateImport.reset();
    ours.marking.reset();
    openPlates.clear();
    plateOpening.reset();
    beforePlate.reset();
    ours.viewport.mode = solved ? ViewMode::relit : ViewMode::photograph;
    autosave.clear();
    autosavedEstimate.reset();
    failedEstimate.reset();
    savedEstimate = ours.document.shotFolder.empty() ? nullptr : history.present().estimate;
    autosavedRevision = history.revision();
    shotLock.reset();
    if (restored) Autosave::discard(*restored);
    restored.reset();
    ours.interrupted.reset();
    dropThumbnails("view:");
    dropThumbnails("env:recovered");
    frameScene();
    remember(ours.recent, documentPath());
    saveSettings(options.configFolder, ours);  // a crash forgets nothing
    if (!solved) tellCheck();
    self.log(LogLevel::info, fmt::format("{}: {} views, {} vertices", documentPath().string(),
                                         ours.document.capture->views.size(), ours.document.scene->mesh.vertexCount()));
}

void Editor::Impl::frameScene() {
    EditorState& ours = self.state;
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
}

void Editor::Impl::openCapture(const fs::path& folder, std::optional<FoundWork> recovered) {
    start(
        JobStatus::Kind::open, "Opening " + folder.filename().string(),
        [this, folder, recovered](Progress& progress) -> Finish {
            const auto document = std::make_shared<Document>(correctedDocument(folder, {}, progress));
            const std::optional<InterruptedEstimate> stopped = interruptedFor(*document, options.stateFolder);
            return [this, document, recovered, stopped] {
                setDocument(std::move(*document), {}, "Opened");
                // Edits without the estimate they were made on: they come back with the next one.
                if (recovered) showRecovered(*recovered, {});
                offerInterrupted(stopped);
            };
        },
        [this](bool) { goOnWhenOpen.clear(); });
}

void Editor::Impl::readAgain(const CaptureFix& fix, const std::string& label) {
    const fs::path folder = self.state.document.captureFolder;
    start(JobStatus::Kind::open, "Reading " + folder.filename().string() + " again",
          [this, folder, fix, label](Progress& progress) -> Finish {
              const auto document = std::make_shared<const Document>(correctedDocument(folder, fix, progress));
              const std::optional<InterruptedEstimate> stopped = interruptedFor(*document, options.stateFolder);
              return [this, document, label, stopped] {
                  Version version;
                  version.inputs = CaptureInputs::of(*document);
                  history.push(label, std::move(version));
                  followHistory();
                  tellCheck();
                  offerInterrupted(stopped);
              };
          });
}

void Editor::Impl::showRecovered(const FoundWork& found, Version saved) {
    // It counts as unsaved until the user saves it, and stays where it was found until our own autosave holds it.
    saved.inputs = history.present().inputs;
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

bool Editor::Impl::askForMissing(const MissingPlaces& missing, const fs::path& folder,
                                 const std::optional<FoundWork>& recovered, OpenAs as, const ShotPlaces& places) {
    using What = MissingQuestion::What;
    if (!missing.capture.empty()) self.state.missing = MissingQuestion{folder, What::capture, missing.capture};
    else if (!missing.measured.empty()) self.state.missing = MissingQuestion{folder, What::measured, missing.measured};
    else if (!missing.environment.empty())
        self.state.missing = MissingQuestion{folder, What::environment, missing.environment};
    else return false;
    missingRecovered = recovered;
    missingPlaces = places;
    missingAs = int(as);
    return true;
}

void Editor::answerMissing(MissingAnswer answer, const fs::path& place) {
    if (!state.missing) return;
    const MissingQuestion question = *state.missing;
    state.missing.reset();
    ShotPlaces places = impl_->missingPlaces;
    const std::optional<FoundWork> recovered = std::exchange(impl_->missingRecovered, {});
    using What = MissingQuestion::What;
    if (answer == MissingAnswer::cancel || impl_->job) return;
    if (answer == MissingAnswer::located) {
        const fs::path there = cleaned(place);
        if (question.what == What::capture) places.capture = captureFolderOf(there);
        else if (question.what == What::environment) places.environment = there;
        else places.measured = there;
    } else if (question.what == What::capture) {
        places.withoutCapture = true;
    } else if (question.what == What::environment) {
        places.withoutEnvironment = true;
    } else {
        return;
    }
    impl_->openShotFolder(question.shot, recovered, Impl::OpenAs(impl_->missingAs), places);
}

void Editor::Impl::openShotFolder(const fs::path& folder, std::optional<FoundWork> recovered, OpenAs as,
                                  const ShotPlaces& places) {
    start(
        JobStatus::Kind::open, "Opening " + folder.filename().string(),
        [this, folder, recovered, as, places](Progress& progress) -> Finish {
            const MissingPlaces missing = relamp::missingPlaces(folder, places);
            if (!missing.capture.empty() || !missing.environment.empty() || !missing.measured.empty())
                return [this, missing, folder, recovered, as, places] {
                    askForMissing(missing, folder, recovered, as, places);
                };
            std::string trouble;
            const auto shot = std::make_shared<Shot>();
            try {
                *shot = openShot(folder, !places.withoutCapture, progress, places);
            } catch (const Error& error) {
                // Without its photographs a shot can still be relit.
                trouble = error.what();
                *shot = openShot(folder, false, progress, places);
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
            const std::optional<InterruptedEstimate> stopped = interruptedFor(*document, options.stateFolder);
            const Snapshots kept = readSnapshots(folder, document->capture->origin);
            return [this, folder, document, shot, trouble, recovered, as, stopped, kept, places] {
                const fs::path saved = document->shotFolder;
                const std::shared_ptr<ShotLock> mine =
                    saved.empty() || as == OpenAs::readOnly ? nullptr : lockFor(saved);
                document->readOnly = as == OpenAs::readOnly || (mine && !mine->owner().empty());
                Version version;
                version.look = shot->look;
                version.estimate = std::make_shared<const Estimate>(std::move(shot->estimate));
                const bool readOnly = document->readOnly;
                // What was missing and has been replaced is an edit like any other.
                const Version found = version;
                if (places.withoutEnvironment || !places.environment.empty()) version.look.environment = {};
                setDocument(std::move(*document), version, "Opened");
                if (!places.environment.empty()) history.push("Locate the environment", found);
                self.state.snapshots = kept;
                if (!places.capture.empty()) ++changesBeside;  // saving keeps its new place
                if (mine && mine->held()) shotLock = mine;
                if (!trouble.empty())
                    self.fail("The photographs could not be opened", trouble,
                              "The shot can be relit and exported. To estimate again, put the photographs back and "
                              "open it again.");
                if (readOnly && as == OpenAs::usual)
                    self.fail("This shot is open elsewhere", saved.string() + " is open: " + mine->owner() + ".",
                              "It was opened read-only: saving asks for another place.");
                if (recovered) {
                    if (folder != saved) savedEstimate.reset();
                    showRecovered(*recovered, version);
                }
                offerInterrupted(stopped);
                if (places.withoutCapture) self.say("Opened without photographs: the shot can be relit and exported");
            };
        },
        [this](bool) { goOnWhenOpen.clear(); });
}

}  // namespace relamp::ui
