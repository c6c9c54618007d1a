// Rendering frames to files in the background.
#include "base/input_files.h"
#include "base/is_there.h"
#include "base/printable.h"
#include "capture/photograph_reader.h"
#include "editor_impl.h"
#include "plate/plate_file.h"
#include "shot/export_frame.h"
#include "shot/frame_jobs.h"
#include "shot/other_photographs.h"
#include "shot/relit_looks.h"
#include "viewport/display_transform.h"
#include "viewport/navigation.h"

namespace relamp::ui {
namespace {
namespace fs = std::filesystem;

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

/// Frames of the plate by number, with what of the range it lacks. Throws Error.
std::vector<FrameJob> plateFramesOf(const ExportRequest& request, const OpenPlate* open,
                                    std::vector<std::string>& lacking) {
    if (!open) throw Error("the plate is not open yet");
    if (open->plate.frames.empty()) throw Error(open->trouble);
    std::vector<int> wanted;
    if (!request.range.empty()) wanted = parseFrameRange(request.range);
    else
        for (const PlateFrame& frame : open->plate.frames) wanted.push_back(frame.number);
    std::vector<FrameJob> jobs;
    for (const int number : wanted) {
        const PlateFrame* frame = open->at(number);
        if (!frame || frame->number != number) {
            lacking.push_back(fmt::format("frame {}: the plate has none that can be relit", number));
            continue;
        }
        const std::string name = numbered(request.file, number);
        if (name.empty() && wanted.size() > 1) throw Error("the name needs #### for the number of the frame");
        FrameJob job;
        job.camera = frame->camera;
        job.file = name.empty() ? request.file : fs::path(name);
        job.number = number;
        jobs.push_back(std::move(job));
    }
    if (jobs.empty()) throw Error("the plate has none of these frames");
    return jobs;
}

/// A way through the views of `range`, counted from 1, as a camera of the command line.
std::string wayThrough(const ExportRequest& request) {
    std::string through;
    for (const int number : parseFrameRange(request.range))
        through += fmt::format("{}{}", through.empty() ? "" : ",", number - 1);
    return fmt::format("path:{}:{}", through, request.moveFrames);
}

/// The frames that were asked for, with their cameras. Throws Error.
std::vector<FrameJob> framesOf(const ExportRequest& request, const Capture& capture,
                               const std::vector<CameraBookmark>& bookmarks, int view, const Camera& eye) {
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
    } else if (request.views == Views::turntable) {
        jobs = frameJobs(capture, fmt::format("turntable:{}", request.moveFrames), "", size, request.file);
    } else if (request.views == Views::path) {
        jobs = frameJobs(capture, wayThrough(request), "", size, request.file);
    } else if (request.views == Views::bookmarks) {
        Capture places;
        for (const CameraBookmark& bookmark : bookmarks) {
            View place;
            place.camera = OrbitCamera::at(bookmark).asCamera(size.empty() ? eye.width : request.width,
                                                              size.empty() ? eye.height : request.height);
            places.views.push_back(std::move(place));
        }
        jobs = frameJobs(places, wayThrough(request), "", "", request.file);
    } else if (request.views == Views::capture) {
        jobs = frameJobs(capture, std::to_string(view), "", size, request.file);
    } else {
        jobs = frameJobs(capture, "all", request.views == Views::range ? request.range : "", size, request.file);
    }
    return jobs;
}

/// All that an export works with; shared with its thread.
struct ExportWork {
    std::vector<FrameJob> jobs;
    std::vector<std::string> failures;  ///< sentences, one a frame that could not be written
    size_t written = 0, asked = 0;
    ExportRequest request;
    Look look;
    std::shared_ptr<const Estimate> estimate;
    std::shared_ptr<const OpenPlate> plate;  ///< null: what is rendered is no plate
    std::optional<ImageRegion> region;
    Camera shown;
    std::string displayView;  ///< of the viewport, with its exposure
    float exposureStops = 0;
    Document document;  ///< of it capture, scene, folder and fix

    void run(Progress& progress, const std::function<void(double)>& whole);

private:
    FrameOptions options_;
    FrameFileOptions fileOptions_;
    LayerRequest layers_;
    std::optional<PhotographReader> photographs_;
    std::optional<StatePhotographs> others_;

    void refuseInputs(Progress& progress) const;
    void writeOne(const FrameJob& job, RelitLooks& looks, PlateRelighter* plates, Progress& progress);
};

/// No frame may take the place of a photograph, the mesh or the plate.
void ExportWork::refuseInputs(Progress& progress) const {
    InputFiles inputs;
    if (isThere(document.captureFolder)) inputs = captureFiles(document.captureFolder, document.fix, progress);
    if (plate) {
        for (const PlateFrame& frame : plate->plate.frames)
            for (const fs::path& file : {frame.file, frame.matte}) inputs.add(file);
        inputs.add(plate->look.cameras);
        inputs.add(plate->look.lens);
    }
    for (const FrameJob& job : jobs) inputs.refuse(job.file);
}

void ExportWork::writeOne(const FrameJob& job, RelitLooks& looks, PlateRelighter* plates, Progress& progress) {
    FrameSources sources;
    sources.origin = document.capture->origin;
    if (plates) {
        const PlateFrame* frame = plate->at(job.number);
        const RelitPlate relit = plates->relit(size_t(frame - plate->plate.frames.data()), progress);
        if (!(relit.covered > 0))
            logWarning("frame {}: its camera sees nothing of the capture; the plate stays as it is", job.number);
        sources.look = &looks.at(job.number, progress);
        if (layers_.correction) sources.captured = &looks.captured(progress);
        writePlateFrame(job.file, *frame, relit, sources, options_, fileOptions_, progress);
        return;
    }
    sources.look = &looks.at(job.number, progress);
    if (const std::optional<ImageBox> box = boxToExport(request, region, shown, job.camera)) {
        const Frame frame = renderFrame(*sources.look, cropped(job.camera, *box), options_, progress);
        writeFrame(job.file, frame, *sources.look, job.camera, request.layers, sources.origin, box, fileOptions_);
        return;
    }
    View photograph;
    if ((fileOptions_.ratio != Ratio::none || layers_.residual || fileOptions_.view == DisplayView::automatic) &&
        job.view >= 0 && !job.resized && isThere(document.captureFolder)) {
        if (!photographs_) {
            LoadOptions load;
            load.fix = document.fix;
            photographs_.emplace(document.captureFolder, load, progress);
        }
        std::vector<std::string> notes;
        photograph = photographs_->read(size_t(job.view), notes, progress);
        sources.photograph = &photograph.image;
        sources.saturation = photograph.saturation;
    }
    std::optional<size_t> state;  // of the photograph; what is shown counts from lights as bright as they get
    if (job.view >= 0) state = document.capture->views[size_t(job.view)].state;
    if (fileOptions_.ratio != Ratio::none && !sources.photograph && isThere(document.captureFolder)) {
        if (!others_) others_.emplace(*document.capture, document.captureFolder, document.fix, std::nullopt);
        if (!state) state = others_->state();
        sources.others = &others_->in(state, looks.captured(progress, state), progress);
    }
    if (fileOptions_.ratio != Ratio::none || layers_.residual || layers_.correction)
        sources.captured = &looks.captured(progress, state);
    writeFrameFile(job.file, job.camera, sources, options_, fileOptions_, progress);
}

void ExportWork::run(Progress& progress, const std::function<void(double)>& whole) {
    refuseInputs(progress);
    options_.samplesPerPixel = plate ? request.plateSamples : request.samples;
    // What is filtered away of the model would be taken for detail of the photograph.
    options_.denoise = request.denoise && (plate || request.ratio == Ratio::none);
    layers_ = layerRequest(request.layers);
    fileOptions_ = {request.layers,
                    request.naming,
                    request.multipart,
                    request.ratio,
                    request.view.value_or(DisplayView::standard),
                    {}};
    if (!request.view)
        fileOptions_.display = [this](Rgb* pixels, size_t count) {
            displayTransform().apply(displayView, exposureStops, pixels, count);
        };
    fileOptions_.exr = request.exr;
    fileOptions_.header = {{"relamp:gauge", estimate->gauge.kind + ": " + estimate->gauge.evidence}};
    const LookTrack track(look);
    RelitLooks looks(*estimate, *document.scene, track);
    // One bar for all of them: what comes before the first image takes a twentieth.
    std::atomic<size_t> index{0};
    std::atomic<bool> begun{false};
    progress.setListener([&](const std::string& label, double fraction) {
        const bool light = label.starts_with("Light of frame");
        if (!begun || !(light || label == "Frame" || label == jobs[index].file.filename().string())) return;
        // Of a plate most of the time is its light.
        const double part = !plate ? fraction : light ? 0.8 * fraction : 0.8 + 0.2 * fraction;
        whole(0.05 + 0.95 * (double(index) + part) / double(jobs.size()));
    });
    const std::shared_ptr<void> quiet(nullptr, [&](void*) { progress.setListener({}); });
    PlateRequest plateRequest;
    std::optional<PlateRelighter> plates;
    if (plate) {
        plateRequest = plate->request;
        plateRequest.ratio = request.ratio == Ratio::none ? Ratio::quotient : request.ratio;
        fileOptions_.ratio = plateRequest.ratio;
        plateRequest.unsure = request.unsure;
        plates.emplace(plate->plate, plateRequest, looks, options_, progress);
        for (const std::string& fault : plates->gains().faults)
            logWarning("{}; left out of the colour matching", fault);
    }
    whole(0.05);
    for (const FrameJob& one : jobs) {
        index = size_t(&one - jobs.data());
        try {
            begun = false;  // applying the look has steps of its own
            looks.at(one.number, progress);
            begun = true;
            writeOne(one, looks, plates ? &*plates : nullptr, progress);
            ++written;
            logInfo("{}: written ({} of {})", one.file.string(), written, jobs.size());
        } catch (const OutOfResources& error) {
            // The others would not fit either.
            failures.insert(failures.begin(), error.what());
            break;
        } catch (const Error& error) { failures.push_back(error.what()); }
    }
}

}  // namespace

void Editor::exportFrames(const ExportRequest& request) {
    const std::shared_ptr<const Estimate> estimate = this->estimate();
    if (!estimate || !state.document.scene) {
        fail("There is nothing to export yet", "Frames are rendered from what was found about the light.",
             "Press Ctrl+Enter to estimate first.");
        return;
    }
    if (impl_->refusedWhileRunning()) return;
    const auto work = std::make_shared<ExportWork>();
    const bool ofPlate = request.views == ExportRequest::Views::plate;
    try {
        work->jobs =
            ofPlate ? plateFramesOf(request, plate().get(), work->failures)
                    : framesOf(request, *state.document.capture, look().bookmarks, state.selection.view, impl_->eye);
    } catch (const Error& error) {
        fail("The export could not start", error.what(), "Change it in the export window and try again.");
        state.panels.exportFrames = true;
        return;
    }
    Impl* impl = impl_.get();
    work->asked = work->jobs.size() + work->failures.size();
    work->request = request;
    work->look = lookThatFits(this->look(), *estimate, state.document.scene->mesh.vertexCount());
    using Views = ExportRequest::Views;
    // Stills show the look of the present frame.
    if (request.views == Views::present || request.views == Views::capture || request.views == Views::all ||
        request.views == Views::range)
        work->look.keys.clear(), work->look.curves.clear();
    work->estimate = estimate;
    if (ofPlate) work->plate = plate();
    work->region = state.viewport.region;
    work->shown = impl->eye;
    work->displayView = displayViewOf(*this);
    work->exposureStops = state.viewport.exposureStops;
    work->document = state.document;
    const size_t count = work->jobs.size();
    impl_->start(
        JobStatus::Kind::exportFrames, count == 1 ? "Rendering a frame" : fmt::format("Rendering {} frames", count),
        [impl, work](Progress& progress) -> Finish {
            work->run(progress, [impl](double whole) { impl->jobWhole = whole; });
            return [impl, work] {
                if (work->failures.empty()) return;
                impl->self.fail(
                    counted(work->asked - work->written, "frame") + " could not be written", work->failures.front(),
                    fmt::format("Written: {}. {}", counted(work->written, "frame"),
                                work->plate && work->jobs.size() == work->written
                                    ? "Those are all that the plate has."
                                    : "Free space or choose another folder, then export the others again."));
            };
        });
}

}  // namespace relamp::ui
