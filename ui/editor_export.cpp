// Rendering frames to files in the background.
#include "base/input_files.h"
#include "base/is_there.h"
#include "capture/photograph_reader.h"
#include "editor_impl.h"
#include "shot/export_frame.h"
#include "shot/frame_jobs.h"

namespace relamp::ui {
namespace {

/// The part of each frame that is rendered; nothing: all of it. `shown` is the viewport's image, from which a frame of
/// another shape takes more or less at its sides.
std::optional<ImageBox> boxToExport(const ExportRequest& request, const std::optional<ImageRegion>& region,
                                    const Camera& shown, const Camera& frame) {
    using Views = ExportRequest::Views;
    if (!region || !request.regionOnly || (request.views != Views::present && request.views != Views::timeline))
        return std::nullopt;
    const double wider = double(frame.width) / frame.height * shown.height / std::max(shown.width, 1);
    const auto side = [&](float x) { return float(std::clamp(0.5 + (double(x) - 0.5) / wider, 0.0, 1.0)); };
    return boxOf({{side(region->low.x), region->low.y}, {side(region->high.x), region->high.y}}, frame.width,
                 frame.height);
}

/// The frames that were asked for, with their cameras. Throws Error.
std::vector<FrameJob> framesOf(const ExportRequest& request, const Capture& capture, int view, const Camera& eye) {
    std::vector<FrameJob> jobs;
    checkLayers(request.layers);
    const std::string size =
        request.width > 0 && request.height > 0 ? fmt::format("{}x{}", request.width, request.height) : "";
    if (request.file.empty()) throw Error("no file name was given");
    using Views = ExportRequest::Views;
    if (request.views == Views::present || request.views == Views::timeline) {
        FrameJob one;
        one.camera = eye;
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
        if (request.views == Views::present) return {one};
        for (const int number : parseFrameRange(request.range)) {
            const std::string name = numbered(request.file, number);
            if (name.empty()) throw Error("the name needs #### for the number of the frame");
            one.file = name;
            one.number = number;
            jobs.push_back(one);
        }
    } else if (request.views == Views::capture) {
        jobs = frameJobs(capture, std::to_string(view), "", size, request.file);
    } else {
        jobs = frameJobs(capture, "all", request.views == Views::range ? request.range : "", size, request.file);
    }
    return jobs;
}

}  // namespace

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
        jobs = framesOf(request, *state.document.capture, state.selection.view, impl_->eye);
    } catch (const Error& error) {
        fail("The export could not start", error.what(), "Change it in the export window and try again.");
        state.panels.exportFrames = true;
        return;
    }
    Impl* impl = impl_.get();
    Look look = lookThatFits(this->look(), *estimate, state.document.scene->mesh.vertexCount());
    if (request.views != ExportRequest::Views::timeline) look.keys.clear();
    impl_->start(
        JobStatus::Kind::exportFrames,
        jobs.size() == 1 ? "Rendering a frame" : fmt::format("Rendering {} frames", jobs.size()),
        [impl, jobs, look, estimate, request, region = state.viewport.region, shown = impl->eye,
         pivots = impl->pivots(), scene = state.document.scene, folder = state.document.captureFolder,
         fix = state.document.fix,
         origin = state.document.capture ? state.document.capture->origin : DVec3(0)](Progress& progress) -> Finish {
            // No frame may take the place of a photograph or the mesh.
            if (isThere(folder)) {
                const InputFiles inputs = captureFiles(folder, fix, progress);
                for (const FrameJob& job : jobs) inputs.refuse(job.file);
            }
            const LookTrack track(look);
            std::optional<RelitScene> relit;
            Look applied;
            FrameOptions options;
            options.samplesPerPixel = request.samples;
            options.denoise = request.denoise;
            std::vector<std::string> failures;
            size_t written = 0;
            // One bar for all of them: what comes before the first image takes a twentieth.
            std::atomic<size_t> index{0};
            progress.setListener([&, impl](const std::string& label, double fraction) {
                if (label == "Frame") impl->jobWhole = 0.05 + 0.95 * (double(index) + fraction) / double(jobs.size());
            });
            const std::shared_ptr<void> quiet(nullptr, [&](void*) { progress.setListener({}); });
            impl->jobWhole = 0.05;
            for (const FrameJob& one : jobs) {
                index = size_t(&one - jobs.data());
                try {
                    if (const Look now = track.at(one.number, pivots); !relit || !(now == applied)) {
                        relit.reset();
                        relit = applyLook(*scene, *estimate, now, progress);
                        applied = now;
                    }
                    const std::optional<ImageBox> box = boxToExport(request, region, shown, one.camera);
                    const Frame frame =
                        renderFrame(*relit, box ? cropped(one.camera, *box) : one.camera, options, progress);
                    writeFrame(one.file, frame, *relit, one.camera, request.layers, origin, box);
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
