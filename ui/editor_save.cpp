// Saving, autosave, and what is asked before work would be lost.
#include "base/is_there.h"

#include "editor_impl.h"
#include "pipeline/shot_of.h"
#include "settings.h"

namespace relamp::ui {
namespace fs = std::filesystem;

namespace {

ShotSource sourceOf(const Document& document) {
    ShotSource source;
    source.captureFolder = document.captureFolder;
    source.fix = document.fix;
    if (document.capture) source.origin = document.capture->origin;
    source.quality = document.quality;
    source.seed = document.seed;
    source.resources = document.resources;
    return source;
}

}  // namespace

void Editor::save() {
    if (!state.document.capture) return;
    if (state.document.shotFolder.empty() || state.document.readOnly) state.panels.saveBrowser = true;
    else impl_->saveTo(state.document.shotFolder);
}

void Editor::saveVersion() {
    const fs::path now = state.document.shotFolder;
    if (now.empty()) return save();
    std::string stem = now.stem().string();
    // NAME-002 goes on from NAME-002.
    int number = 1;
    if (const size_t dash = stem.rfind('-'); dash != std::string::npos && dash + 4 == stem.size() &&
                                             stem.find_first_not_of("0123456789", dash + 1) == std::string::npos) {
        number = std::stoi(stem.substr(dash + 1));
        stem.resize(dash);
    }
    fs::path next;
    do next = now.parent_path() / fmt::format("{}-{:03}.relamp", stem, ++number);
    while (isThere(next));
    impl_->saveTo(next);
    say("Saving " + next.filename().string());
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
    const uint64_t revision = history.revision(), beside = changesBeside;
    saving = std::make_unique<Job<Finish>>(
        [this, version, estimate, document, folder, entry, revision, beside, mine,
         kept = self.state.snapshots](Progress&) -> Finish {
            const Shot shot = shotOf(*estimate, sourceOf(document), version.look);
            saveShot(shot, document.scene->mesh, folder, true);
            writeSnapshots(kept, folder, document.capture->origin);
            return [this, folder, entry, revision, beside, mine, estimate] {
                self.state.document.shotFolder = folder;
                self.state.document.readOnly = false;
                shotLock = mine->held() ? mine : nullptr;
                savedEstimate = estimate;
                savedBeside = beside;
                // Edits made while it was written are still unsaved.
                if (history.index() == entry && history.revision() == revision) {
                    history.markSaved();
                    autosave.clear();
                    autosavedEstimate.reset();
                    if (restored) Autosave::discard(*restored);
                    restored.reset();
                }
                remember(self.state.recent, folder);
                saveSettings(options.configFolder, self.state);
                self.say(folder.string() + ": saved");
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
            const Shot shot = shotOf(*version.estimate, sourceOf(document), version.look);
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
    const bool estimating = impl_->job && impl_->status->kind == JobStatus::Kind::solve;
    std::optional<JobStatus::Kind> running;
    if (impl_->job &&
        (impl_->status->kind == JobStatus::Kind::exportFrames || impl_->status->kind == JobStatus::Kind::search))
        running = impl_->status->kind;
    if (estimating || running || unsavedChanges())
        state.unsaved = UnsavedQuestion{UnsavedQuestion::Then::quit, {}, estimating, unsavedChanges(), running};
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

// ---- autosave

double Editor::Impl::seconds() const {
    return options.seconds ? options.seconds() : std::chrono::duration<double>(Clock::now().time_since_epoch()).count();
}

bool Editor::Impl::estimateIsOnDisk() const {
    const auto& present = history.present().estimate;
    return !present || present == savedEstimate || present == autosavedEstimate;
}

void Editor::Impl::writeAutosave() {
    AutosavedWork work;
    work.captureFolder = self.state.document.captureFolder;
    work.shotFolder = self.state.document.shotFolder;
    // A capture that was just read anew has no estimate yet: what would be lost is the work before that.
    const std::vector<HistoryEntry>& entries = history.entries();
    size_t last = history.index();
    while (last > 0 && !entries[last].version.estimate) --last;
    if (!entries[last].version.estimate) last = history.index();
    const auto& worked = entries[last].version.estimate;
    if (worked && worked == autosavedEstimate && worked != savedEstimate) work.estimateShot = autosavedFolder;
    work.look = last == history.index() ? self.look() : entries[last].version.look;
    // Undo comes back as well, as far as it leads on the same estimate.
    constexpr size_t mostSteps = 50;
    size_t first = last;
    while (first > 0 && last - first + 1 < mostSteps && entries[first - 1].version.estimate == worked) --first;
    for (size_t i = first; i <= last; ++i) work.steps.push_back({entries[i].label, entries[i].version.look});
    if (status && status->kind == JobStatus::Kind::solve)
        work.stage = status->title + (status->stage.empty() ? "" : ", " + status->stage);
    lastAutosave = seconds();
    try {
        autosave.write(work);
        autosavedRevision = history.revision();
        autosaveFailed = false;
        if (!saving) autosave.keepEstimate(work.estimateShot);
        if (work.estimateShot.empty()) autosavedEstimate.reset();
        // What was restored is now as safe as it was.
        if (restored && autosave.working() && estimateIsOnDisk()) {
            Autosave::discard(*restored);
            restored.reset();
        }
    } catch (const Error& error) {
        if (!std::exchange(autosaveFailed, true))
            self.fail("Your edits could not be saved by themselves", error.what(),
                      "Free some space, or save the shot to another disk with Ctrl+Shift+S.");
    }
}

void Editor::autosave() {
    if (!unsavedChanges()) return;
    if (impl_->estimateIsOnDisk()) impl_->writeAutosave();
    else impl_->saveUnsavedEstimate();
}

void Editor::Impl::pollAutosave() {
    // A long drag counts as well: what it began with and what it has come to.
    const bool dragged = history.inGesture() && !(self.look() == history.gestureStart());
    if (!self.state.document.capture || (!self.unsavedChanges() && !dragged)) return;
    if (!estimateIsOnDisk() && autosave.working()) {
        const bool failed = history.present().estimate == failedEstimate;
        if (!saving && (!failed || seconds() - lastEstimateTry > 60)) saveUnsavedEstimate();
        // The work on disk goes with the estimate on disk until both are new.
        if (!failed) return;
    }
    if (autosavedRevision == history.revision() || seconds() - lastAutosave < options.autosaveSeconds) return;
    writeAutosave();
}

bool Editor::unsavedChanges() const {
    if (!state.document.capture) return false;
    // A capture that was read otherwise before anything was estimated is nothing that could be lost.
    const auto worth = [](const HistoryEntry& entry) {
        const Version& version = entry.version;
        return version.estimate || version.distantOnly || !(version.look == Look{});
    };
    const std::vector<HistoryEntry>& entries = history().entries();
    return impl_->changesBeside != impl_->savedBeside ||
           (history().unsavedChanges() && std::any_of(entries.begin(), entries.end(), worth));
}

void Editor::Impl::offerLostWork() {
    if (lost.empty()) return;
    const FoundWork& found = lost.front();
    const fs::path project = found.work.shotFolder.empty() ? found.work.captureFolder : found.work.shotFolder;
    self.state.recovery = RecoveryOffer{found.file, project.string(), found.work.time, found.work.stage};
}

void Editor::answerRecovery(bool restore) {
    if (!state.recovery) return;
    state.recovery.reset();
    const FoundWork found = impl_->lost.front();
    impl_->lost.erase(impl_->lost.begin());
    if (!restore) {
        Autosave::discard(found);
        impl_->offerLostWork();
        return;
    }
    const AutosavedWork& work = found.work;
    const fs::path shot =
        !work.estimateShot.empty() && isThere(work.estimateShot / "shot.json") ? work.estimateShot : work.shotFolder;
    if (!shot.empty()) {
        impl_->openShotFolder(shot, found);
    } else {
        impl_->openCapture(work.captureFolder, found);
    }
}

}  // namespace relamp::ui
