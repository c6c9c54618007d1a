#include "report/solve_report.h"

#include "base/atomic_file.h"
#include "base/log.h"
#include "capture/own_axes.h"
#include "display/display_image.h"
#include "pipeline/pipeline.h"
#include "relight/frame.h"
#include "shot/relit_looks.h"

namespace relamp {
namespace {

namespace fs = std::filesystem;
constexpr size_t mostViews = 24;
constexpr int longestSide = 400;

struct ViewImages {
    Image photograph, model;
    double psnr = 0;
    float exposure = 1;
};

ViewImages explain(const RelitScene& relit, const View& view, Progress& progress) {
    ViewImages p;
    const Camera camera = smallerCamera(view.camera, longestSide);
    p.photograph = shrunk(view.image, camera.width, camera.height);
    p.exposure = exposureFor(p.photograph);
    FrameOptions options;
    options.samplesPerPixel = 4;
    options.denoise = true;
    const Frame frame = renderFrame(relit, camera, options, progress);
    p.model = Image(frame.width, frame.height);
    p.model.pixels = frame.beauty;
    std::vector<uint8_t> mask(frame.alpha.size());
    for (size_t i = 0; i < mask.size(); ++i) mask[i] = frame.alpha[i] > 0.999f && p.photograph.usable[i];
    p.psnr = displayError(p.model, p.photograph, mask, p.exposure).psnr();
    return p;
}

/// Per view, near-field beside distant-only when that was solved, and the images of the view explained least well.
void measureViews(const Capture& capture, const Scene& scene, SolveReport& report, Progress& progress) {
    const LookTrack asFound(Look{});
    RelitLooks looks(report.estimate, scene, asFound);
    std::optional<RelitLooks> distant;
    if (report.distant) distant.emplace(report.distant->estimate, scene, asFound);
    const size_t count = std::min(mostViews, capture.views.size());
    double worst = 1e9;
    for (size_t i = 0; i < count; ++i) {
        const View& view = capture.views[i * capture.views.size() / count];
        ViewImages p = explain(looks.captured(progress, view.state), view, progress);
        report.views.push_back(
            {view.name, p.psnr, distant ? explain(distant->captured(progress, view.state), view, progress).psnr : 0});
        if (p.psnr >= worst) continue;
        worst = p.psnr;
        report.worst = ReportedWorst{view.name, scaledBy(p.photograph, p.exposure), scaledBy(p.model, p.exposure),
                                     differenceOf(p.model, p.photograph, p.exposure)};
    }
}

/// Why no distant-only solve is worth its time; empty when it is.
std::string withoutDistant(const Shot& shot, const ReportOptions& options) {
    if (options.againstDistant == ReportOptions::Distant::off) return "it was not asked for";
    if (shot.estimate.mode == "distant-only") return "this shot is one itself";
    if (options.againstDistant == ReportOptions::Distant::automatic && shot.resources.seconds > options.mostSeconds)
        return fmt::format("this shot took {:.0f} s, more than {:.0f} s; ask for it with --against-distant on",
                           shot.resources.seconds, options.mostSeconds);
    return "";
}

/// Solves the capture again as the shot was solved, and holds what stands after each large step against the truth.
std::vector<TruthMoment> followTruth(const Shot& shot, const Scene& scene, const ReportOptions& options,
                                     Progress& progress) {
    PipelineOptions pipeline;
    pipeline.load.fix = shot.fix;
    pipeline.solve = solveOptionsFor(shot.quality);
    pipeline.solve.seed = shot.seed;
    pipeline.solve.nearField = shot.estimate.mode != "distant-only";
    struct Moment {
        double seconds;
        Estimate estimate;
    };
    std::vector<Moment> moments;
    const double start = progress.seconds();
    SolveListener listener;
    listener.snapshot = [&](Estimate estimate) {
        moments.push_back({progress.seconds() - start, std::move(estimate)});
    };
    Estimate last = runPipeline(shot.captureFolder, pipeline, progress, &listener).estimate;
    moments.push_back({progress.seconds() - start, std::move(last)});
    std::vector<TruthMoment> found;
    for (Moment& m : moments) {
        Shot then = shot;
        then.estimate = std::move(m.estimate);
        found.push_back({m.seconds, truthFigures(options.truth, then, scene, progress).meanPsnr});
    }
    return found;
}

}  // namespace

void writeReport(const fs::path& folder, const fs::path& page, const ReportOptions& options, Progress& progress) {
    SolveReport report;
    report.shot = fs::absolute(folder / ".").lexically_normal().parent_path().filename().string();
    Shot shot = openShot(folder, false, progress);
    const fs::path stem = page.parent_path() / page.stem();
    InputFiles inputs = shotFiles(shot, progress);
    if (!options.truth.empty()) inputs.addFolder(options.truth);
    inputs.refuse(page);
    for (const char* ending :
         {"-timeline.csv", "-views.csv", "-error.svg", "-spectrum.svg", "-truth.csv", "-truth.svg"})
        inputs.refuse(stem.string() + ending);
    try {
        shot.capture = openShot(folder, true, progress).capture;
    } catch (const Error& error) {
        report.noViewsBecause = fmt::format("the photographs cannot be read ({})", error.what());
    }
    const Scene scene = buildScene(shot.capture.mesh, progress, ownAxes(shot.capture));
    report.capture = fs::absolute(shot.captureFolder / ".").lexically_normal().parent_path().filename().string();
    report.estimate = shot.estimate;
    report.origin = shot.capture.origin;
    report.resources = shot.resources;
    report.quality = shot.quality;
    report.noDistantBecause = report.noViewsBecause.empty() ? withoutDistant(shot, options) : report.noViewsBecause;
    if (report.noDistantBecause.empty()) {
        PipelineOptions pipeline;
        pipeline.load.fix = shot.fix;
        pipeline.solve = solveOptionsFor(shot.quality);
        pipeline.solve.seed = shot.seed;
        pipeline.solve.nearField = false;
        const double start = progress.seconds();
        ReportedDistant distant;
        distant.estimate = runPipeline(shot.captureFolder, pipeline, progress).estimate;
        distant.seconds = progress.seconds() - start;
        for (TimelineEntry& entry : distant.estimate.timeline) entry.seconds -= start;
        logInfo("distant-only: solved in {:.1f} s", distant.seconds);
        report.distant = std::move(distant);
    }
    if (report.noViewsBecause.empty()) measureViews(shot.capture, scene, report, progress);
    if (!options.truth.empty()) report.truth = truthFigures(options.truth, shot, scene, progress);
    if (report.truth && report.truth->meanPsnr > 0 && report.noViewsBecause.empty())
        report.truthOverTime = followTruth(shot, scene, options, progress);

    const auto write = [&](const char* ending, const std::string& text) {
        if (!text.empty()) writeBytesAtomically(stem.string() + ending, text);
    };
    write("-timeline.csv", timelineCsv(report));
    write("-views.csv", viewsCsv(report));
    write("-error.svg", errorPlot(report));
    write("-spectrum.svg", spectrumPlot(report));
    write("-truth.csv", truthCsv(report));
    write("-truth.svg", truthPlot(report));
    writeBytesAtomically(page, reportPage(report));
}

}  // namespace relamp
