// relamp render: frames of a shot under a look, from any camera, one after the other.
#include <optional>

#include "base/is_there.h"
#include "base/log.h"
#include "base/parallel.h"
#include "capture/own_axes.h"
#include "capture/photograph_reader.h"
#include "commands.h"
#include "relight/look_track.h"
#include "shot/export_frame.h"
#include "shot/shot_file.h"
#include "shot/shot_hash.h"

namespace relamp::cli {
namespace {

LookTrack trackOf(const RenderArguments& a, const Shot& shot) {
    LookTrack track = a.edits.empty() ? LookTrack(shot.look) : readLookTrack(a.edits, shot.capture.origin);
    track.apply([&](Look& look) {
        if (a.environment == "none") look.environment.source = EnvironmentLook::Source::none;
        else if (a.environment == "recovered") look.environment.source = EnvironmentLook::Source::recovered;
        else if (!a.environment.empty()) {
            look.environment.source = EnvironmentLook::Source::file;
            look.environment.file = a.environment;
        }
        look.environment.yawDegrees += a.yaw;
    });
    return track;
}

/// Throws Error where a frame would replace a file that this command reads.
void refuseInputs(const RenderArguments& a, const Shot& shot, const LookTrack& track, const std::vector<FrameJob>& jobs,
                  Progress& progress) {
    InputFiles inputs = shotFiles(shot, progress);
    inputs.add(a.edits);
    inputs.add(a.camera);
    LookTrack(track).apply([&](Look& look) {
        for (const auto& file : filesOf(look)) inputs.add(file);
    });
    for (const FrameJob& job : jobs) inputs.refuse(job.file);
}

LookPivots pivotsOf(const Shot& shot) {
    LookPivots pivots;
    pivots.emitter = [&shot](const std::string& id) {
        for (const EmitterCluster& e : shot.estimate.emitters.emitters)
            if (e.id == id) return e.centroid;
        return Vec3(0);
    };
    pivots.vertex = [&shot](uint32_t v) {
        return v < shot.capture.mesh.vertexCount() ? shot.capture.mesh.positions[v] : Vec3(0);
    };
    return pivots;
}

FrameFileOptions fileOptionsOf(const RenderArguments& a) {
    FrameFileOptions options;
    options.layers = a.layers;
    options.naming = layerNaming(a.naming);
    options.multipart = a.multipart;
    options.view = displayView(a.view);
    if (!a.ratio.empty()) options.ratio = a.ratio == "difference" ? Ratio::difference : Ratio::quotient;
    return options;
}

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

/// The looks of a sequence applied, each kept as long as it lasts.
class RelitLooks {
public:
    RelitLooks(const Shot& shot, const Scene& scene, const LookTrack& track)
        : shot_(shot), scene_(scene), track_(track), pivots_(pivotsOf(shot)) {}

    const RelitScene& at(int frame, Progress& progress) {
        Look look = track_.at(frame, pivots_);
        if (!relit_ || !(look == look_)) {
            relit_.reset();
            relit_ = applyLook(scene_, shot_.estimate, look, progress);
            look_ = std::move(look);
        }
        return *relit_;
    }
    /// The light as photographed.
    const RelitScene& captured(Progress& progress) {
        if (relit_ && look_ == Look{}) return *relit_;
        if (!captured_) captured_ = applyLook(scene_, shot_.estimate, Look{}, progress);
        return *captured_;
    }

private:
    const Shot& shot_;
    const Scene& scene_;
    const LookTrack& track_;
    LookPivots pivots_;
    Look look_;
    std::optional<RelitScene> relit_, captured_;
};

}  // namespace

int render(const RenderArguments& a, Progress& progress) {
    const ThreadLimit limit(a.threads);
    LayerRequest request;
    FrameFileOptions fileOptions;
    try {
        request = layerRequest(a.layers);
        fileOptions = fileOptionsOf(a);
    } catch (const BadOption& error) { throw UsageError(error.what()); }
    const bool photographs =
        fileOptions.ratio != Ratio::none || request.residual || fileOptions.view == DisplayView::automatic;
    const Shot shot = openShot(a.shot, false, progress);
    const LookTrack track = trackOf(a, shot);
    std::vector<FrameJob> jobs;
    try {
        jobs = frameJobs(shot.capture, a.camera, a.frames, a.size, a.output);
        const bool needsPhotograph = fileOptions.ratio != Ratio::none || (request.residual && !request.all);
        for (const FrameJob& job : jobs)
            if (needsPhotograph && (job.view < 0 || job.resized))
                throw BadOption("{}: needs a photograph: --camera a view's number or all, without --size",
                                fileOptions.ratio != Ratio::none ? "--ratio" : "--layers residual");
    } catch (const BadOption& error) { throw UsageError(error.what()); }
    refuseInputs(a, shot, track, jobs, progress);
    fileOptions.header = {{"relamp:gauge", shot.estimate.gauge.kind + ": " + shot.estimate.gauge.evidence},
                          {"relamp:shot", shotHash(a.shot)}};
    const Scene scene = buildScene(shot.capture.mesh, progress, ownAxes(shot.capture));
    RelitLooks looks(shot, scene, track);
    Photographs taken(shot);
    FrameOptions options;
    options.seed = a.seed;
    options.denoise = a.denoise == "on" || (a.denoise == "auto" && fileOptions.ratio == Ratio::none);
    if (a.samples > 0) options.samplesPerPixel = a.samples;
    int failures = 0, written = 0, skipped = 0;
    std::optional<Error> first;
    for (const FrameJob& job : jobs) {
        if (a.skipExisting && isThere(job.file)) {
            logInfo("{}: exists, skipped", job.file.string());
            ++skipped;
            continue;
        }
        try {
            FrameSources sources;
            sources.origin = shot.capture.origin;
            sources.look = &looks.at(job.number, progress);
            if (const View* view = photographs ? taken.of(job, progress) : nullptr) {
                sources.photograph = &view->image;
                sources.saturation = view->saturation;
            }
            if (fileOptions.ratio != Ratio::none || request.residual || request.correction)
                sources.captured = &looks.captured(progress);
            const double groupError = writeFrameFile(job.file, job.camera, sources, options, fileOptions, progress);
            ++written;
            logInfo("{}: written ({} of {}), light groups and rest are the beauty within {:.2g}", job.file.string(),
                    written, jobs.size(), groupError);
        } catch (const OutOfResources& error) {
            if (!written) throw;
            // The others would not fit either; --skip-existing goes on from here.
            logWarning("{}; stopped after {} of {} frames", error.what(), written, jobs.size());
            ++failures;
            break;
        } catch (const Error& error) {
            if (jobs.size() == 1) throw;
            logWarning("{}", error.what());
            if (!first) first = error;
            ++failures;
        }
    }
    if (first && !written && !skipped) throw *first;
    return failures ? 5 : 0;
}

}  // namespace relamp::cli
