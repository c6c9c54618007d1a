// relamp render: frames of a shot under a look, from any camera, one after the other.
#include <optional>

#include "base/log.h"
#include "base/parallel.h"
#include "capture/own_axes.h"
#include "capture/photograph_reader.h"
#include "commands.h"
#include "render_frames.h"
#include "shot/export_frame.h"
#include "shot/other_photographs.h"
#include "shot/relit_looks.h"
#include "shot/shot_file.h"
#include "shot/shot_hash.h"

namespace relamp::cli {
namespace {

/// The photographs of jobs whose cameras are views of the capture at their own sizes; one is held at a time.
class Photographs {
public:
    explicit Photographs(const Shot& shot) : shot_(shot) {}

    /// Null where the job's camera took none.
    const View* of(const FrameJob& job, Progress& progress) {
        if (job.view < 0 || job.resized) return nullptr;
        if (!reader_) {
            LoadOptions options;
            options.fix = shot_.fix;
            reader_.emplace(shot_.captureFolder, options, progress);
        }
        if (held_ == job.view) return &view_;
        held_ = -1;
        view_ = {};
        std::vector<std::string> notes;
        view_ = reader_->read(size_t(job.view), notes, progress);
        held_ = job.view;
        return &view_;
    }

private:
    const Shot& shot_;
    std::optional<PhotographReader> reader_;
    View view_;
    int held_ = -1;
};

}  // namespace

int render(const RenderArguments& a, Progress& progress) {
    const ThreadLimit limit(a.threads);
    if (!a.plate.empty()) return renderPlate(a, progress);
    LayerRequest request;
    FrameFileOptions fileOptions;
    try {
        request = layerRequest(a.layers);
        fileOptions = fileOptionsOf(a);
    } catch (const BadOption& error) { throw UsageError(error.what()); }
    const bool photographs =
        fileOptions.ratio != Ratio::none || request.residual || fileOptions.view == DisplayView::automatic;
    const Shot shot = openShot(a.shot, false, progress);
    const Look look = lookOf(a, shot);
    if (look.plate && a.camera.empty() && a.size.empty()) {
        logInfo("{}: the plate of the look is relit; --camera renders other frames", look.plate->files.string());
        return relightPlate(a, shot, look, progress);
    }
    const LookTrack track = trackOf(a, look);
    const std::optional<size_t> state = stateOf(a.state, shot);
    std::vector<FrameJob> jobs;
    try {
        jobs = frameJobs(shot.capture, a.camera.empty() ? "0" : a.camera, a.frames, a.size, a.output);
        for (const FrameJob& job : jobs)
            if (request.residual && !request.all && (job.view < 0 || job.resized))
                throw BadOption(
                    "--layers residual: needs a photograph: --camera a view's number or all, without --size");
    } catch (const BadOption& error) { throw UsageError(error.what()); }
    if (jobs.front().still && !track.moves())
        logWarning(
            "--frames {}: all frames are the same, because neither camera nor look changes; --camera all has a frame "
            "for each photograph, --edits a look with keys",
            a.frames);
    std::vector<fs::path> files;
    for (const FrameJob& job : jobs) files.push_back(job.file);
    refuseInputs(a, shot, track, files, progress);
    fileOptions.header = {{"relamp:gauge", shot.estimate.gauge.kind + ": " + shot.estimate.gauge.evidence},
                          {"relamp:shot", shotHash(a.shot)}};
    const Scene scene = buildScene(shot.capture.mesh, progress, ownAxes(shot.capture));
    RelitLooks looks(shot, scene, track);
    looks.base(state);
    Photographs taken(shot);
    StatePhotographs others(shot.capture, shot.captureFolder, shot.fix, state);
    FrameOptions options;
    options.seed = a.seed;
    options.denoise = a.denoise == "on" || (a.denoise == "auto" && fileOptions.ratio == Ratio::none);
    if (a.samples > 0) options.samplesPerPixel = a.samples;
    return writeFrames(files, a.skipExisting, [&](size_t index) {
        const FrameJob& job = jobs[index];
        FrameSources sources;
        sources.origin = shot.capture.origin;
        std::optional<size_t> ofView;
        if (job.view >= 0) ofView = shot.capture.views[size_t(job.view)].state;
        // An edits document counts from lights as bright as they get, whichever view sees them.
        sources.look = &looks.at(job.number, progress, a.edits.empty() ? ofView : std::nullopt);
        if (const View* view = photographs ? taken.of(job, progress) : nullptr) {
            sources.photograph = &view->image;
            sources.saturation = view->saturation;
        } else if (fileOptions.ratio != Ratio::none) {
            if (!ofView) ofView = others.state();
            sources.others = &others.in(ofView, looks.captured(progress, ofView), progress);
        }
        if (fileOptions.ratio != Ratio::none || request.residual || request.correction)
            sources.captured = &looks.captured(progress, ofView);
        const double groupError = writeFrameFile(job.file, job.camera, sources, options, fileOptions, progress);
        return fmt::format("light groups and rest are the beauty within {:.2g}", groupError);
    });
}

}  // namespace relamp::cli
