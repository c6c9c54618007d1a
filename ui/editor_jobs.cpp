// Background jobs of the editor: one at a time. The worker gets its inputs by shared_ptr and gives back one step that
// the window's thread runs.
#include "editor_impl.h"

namespace relamp::ui {
namespace fs = std::filesystem;

fs::path cleaned(const fs::path& path) {
    std::error_code failed;
    fs::path p = fs::absolute(path, failed).lexically_normal();
    if (failed) p = path.lexically_normal();
    if (p.filename().empty()) p = p.parent_path();
    return p;
}

std::string whereFull(const std::exception& error) {
    if (dynamic_cast<const OutOfResources*>(&error))
        return "Free some space or choose another disk, then try again. Your edits are still here.";
    return "Your edits are still here.";
}

fs::path Editor::Impl::documentPath() const {
    return self.state.document.shotFolder.empty() ? self.state.document.captureFolder : self.state.document.shotFolder;
}

bool Editor::Impl::refusedWhileRunning() {
    if (!job) return false;
    self.fail("Something else is running", status->title + " is not finished.",
              "Wait for it, or stop it in the status bar.");
    return true;
}

void Editor::Impl::start(JobStatus::Kind kind, const std::string& title, std::function<Finish(Progress&)> work,
                         std::function<void(bool)> onEnd) {
    status = JobStatus{};
    status->kind = kind;
    status->title = title;
    onJobEnd = std::move(onEnd);
    jobWhole = -1;
    wholeAt = 0;
    stageNow.clear();
    stageSince = 0;
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

void Editor::Impl::tellWholeJob() {
    if (stageNow != status->stage) {
        stageNow = status->stage;
        stageSince = status->seconds;
    }
    if (status->kind == JobStatus::Kind::solve) {
        status->secondsLeft = solveSecondsLeft();
        if (status->secondsLeft && status->seconds > 0) {
            // What is missing goes at the pace of the time left: the bar neither stands nor goes back where that grows.
            const double left = std::max(*status->secondsLeft, 0.5), since = status->seconds - wholeAt;
            status->whole = 1 - (1 - status->whole.value_or(0)) * left / (left + since);
            wholeAt = status->seconds;
        }
    } else if (const double whole = jobWhole; whole >= 0) {
        status->whole = std::max(status->whole.value_or(0), whole);
        if (whole > 0.02) status->secondsLeft = status->seconds * (1 - whole) / whole;
    }
    // Full when it is done, not before.
    if (status->whole) status->whole = std::min(*status->whole, 0.99);
}

void Editor::Impl::pollJob() {
    if (!job) return;
    Progress& progress = job->progress();
    status->stage = progress.label();
    status->fraction = progress.fraction();
    status->seconds = progress.seconds();
    tellWholeJob();
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

}  // namespace relamp::ui
