// relamp render --plate: frames of a tracked, moving camera relit.
#include "base/log.h"
#include "base/parallel.h"
#include "capture/own_axes.h"
#include "plate/plate_file.h"
#include "render_frames.h"
#include "shot/shot_hash.h"

namespace relamp::cli {
namespace {

struct PlateOptions {
    PlateRequest request;
    FrameFileOptions file;
    bool correction = false;
};

/// Throws UsageError.
PlateOptions readOptions(const RenderArguments& a) {
    PlateOptions options;
    try {
        options.correction = layerRequest(a.layers).correction;
        options.file = fileOptionsOf(a);
        options.request = plateRequest({a.plate, a.plateCamera, a.plateLens, a.matte, a.plateOffset, a.plateRotation,
                                        a.plateCurve, a.plateMatch, a.matteLight == "relight"});
        options.request.neighbours = a.plateSteady;
        options.request.unsure = plateUnsure(a.plateUnsure);
        options.request.ratio = options.file.ratio == Ratio::none ? Ratio::quotient : options.file.ratio;
        options.file.ratio = options.request.ratio;
    } catch (const BadOption& error) { throw UsageError(error.what()); }
    return options;
}

RenderArguments withPlate(RenderArguments a, const PlateLook& plate) {
    a.plate = plate.files, a.plateCamera = plate.cameras, a.plateLens = plate.lens, a.matte = plate.matte;
    a.plateOffset = plate.offset, a.plateRotation = plate.rotation;
    a.plateCurve = plate.curve, a.plateMatch = plate.match;
    a.matteLight = plate.relightMatte ? "relight" : "keep";
    return a;
}

/// The frames that were asked for with the files they become.
struct PlateJobs {
    std::vector<size_t> frames;  ///< of the plate
    std::vector<fs::path> files;
    bool lacking = false;  ///< one that was asked for cannot be relit
};

/// "1 to 3"
std::string rangeOf(const Plate& plate) { return fmt::format("{} to {}", plate.first, plate.last); }

PlateJobs jobsOf(const RenderArguments& a, const Plate& plate) {
    PlateJobs jobs;
    std::vector<int> wanted;
    if (!a.frames.empty()) wanted = parseFrameRange(a.frames);
    else
        for (const PlateFrame& frame : plate.frames) wanted.push_back(frame.number);
    if (!a.frames.empty() && std::all_of(wanted.begin(), wanted.end(), [&](int n) { return n < plate.first; }))
        throw BadOption("--frames {}: holds none of the plate's frames {}", a.frames, rangeOf(plate));
    for (const int number : wanted) {
        if (number < plate.first || number > plate.last) {
            logWarning("frame {}: outside the plate's {}, skipped", number, rangeOf(plate));
            continue;
        }
        const auto frame = std::find_if(plate.frames.begin(), plate.frames.end(),
                                        [&](const PlateFrame& f) { return f.number == number; });
        if (frame == plate.frames.end()) {
            logWarning("frame {}: the plate has none that can be relit, skipped", number);
            jobs.lacking = true;
            continue;
        }
        std::string file = numbered(a.output, number);
        if (file.empty() && wanted.size() > 1)
            throw BadOption("{}: several frames need a name with #### or %04d", a.output.string());
        jobs.frames.push_back(size_t(frame - plate.frames.begin()));
        jobs.files.emplace_back(file.empty() ? a.output.string() : file);
    }
    if (wanted.empty()) throw Error("{}", plate.faults.front());
    if (jobs.frames.empty() && jobs.lacking)
        throw BadOption("--frames {}: holds no frame of the plate that can be relit", a.frames);
    return jobs;
}

void say(const PlateGains& gains) {
    for (const std::string& fault : gains.faults) logWarning("{}; left out of the colour matching", fault);
    if (gains.keys.empty()) {
        logInfo("the plate's colours were not matched to the capture's");
        return;
    }
    const Rgb first = gains.keys.begin()->second;
    logInfo("the plate is the capture times {:.3f} {:.3f} {:.3f}{}; key frames differ by {:.2f} %", first.x, first.y,
            first.z, gains.breathes ? " at first and follows the plate" : "", 100 * gains.spread);
}

}  // namespace

int renderPlate(const RenderArguments& a, Progress& progress) {
    if (!a.camera.empty()) throw UsageError("--camera: a plate has its own, --plate-camera");
    if (!a.size.empty()) throw UsageError("--size: a plate keeps its own");
    readOptions(a);  // before a shot is opened
    const Shot shot = openShot(a.shot, false, progress);
    return relightPlate(a, shot, lookOf(a, shot), progress);
}

int relightPlate(const RenderArguments& given, const Shot& shot, const Look& look, Progress& progress) {
    const RenderArguments a = given.plate.empty() && look.plate ? withPlate(given, *look.plate) : given;
    const PlateOptions asked = readOptions(a);
    const PlateRequest& request = asked.request;
    const LookTrack track = trackOf(a, look);
    Plate plate;
    PlateJobs jobs;
    try {
        plate = openPlate(shot.capture, request, progress);
        for (const std::string& note : plate.notes) logInfo("{}", note);
        for (const std::string& fault : plate.faults) logWarning("{}", fault);
        jobs = jobsOf(a, plate);
    } catch (const BadOption& error) { throw UsageError(error.what()); }
    if (jobs.files.empty()) return 0;  // a part of a sequence that lies behind its end
    std::vector<fs::path> outputs = jobs.files;
    if (request.relightMatte)
        for (const fs::path& file : jobs.files) outputs.push_back(plateLightFile(file));
    refuseInputs(a, shot, track, outputs, progress);
    FrameFileOptions fileOptions = asked.file;
    fileOptions.header = {{"relamp:gauge", shot.estimate.gauge.kind + ": " + shot.estimate.gauge.evidence},
                          {"relamp:shot", shotHash(a.shot)}};
    const Scene scene = buildScene(shot.capture.mesh, progress, ownAxes(shot.capture));
    RelitLooks looks(shot, scene, track);
    looks.base(stateOf(a.state, shot));
    FrameOptions options;
    options.seed = a.seed;
    options.denoise = a.denoise != "off";
    options.samplesPerPixel = a.samples > 0 ? a.samples : defaultPlateSamples;
    PlateRelighter relighter(plate, request, looks, options, progress);
    say(relighter.gains());
    const int code = writeFrames(jobs.files, a.skipExisting, [&](size_t index) {
        const size_t at = jobs.frames[index];
        const PlateFrame& frame = plate.frames[at];
        const RelitPlate relit = relighter.relit(at, progress);
        if (!(relit.covered > 0))
            logWarning("frame {}: its camera sees nothing of the capture; the plate stays as it is", frame.number);
        if (request.relightMatte && !relit.matteLight && !frame.matte.empty())
            logWarning("frame {}: the light at the matte is not known; what it holds out stays as it is", frame.number);
        FrameSources sources;
        sources.origin = shot.capture.origin;
        sources.look = &looks.at(frame.number, progress);
        if (asked.correction) sources.captured = &looks.captured(progress);
        writePlateFrame(jobs.files[index], frame, relit, sources, options, fileOptions, progress);
        return fmt::format("the capture's surfaces cover {:.0f} % of it", 100 * relit.covered);
    });
    // A part of a sequence fails for its own frames alone.
    const bool lacking = a.frames.empty() ? !plate.faults.empty() : jobs.lacking;
    return code == 0 && lacking ? 5 : code;
}

}  // namespace relamp::cli
