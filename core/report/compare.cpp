#include "report/compare.h"

#include "base/atomic_file.h"
#include "base/log.h"
#include "base/parallel.h"
#include "base/printable.h"
#include "capture/photograph_reader.h"
#include "pipeline/shot_of.h"
#include "report/comparison.h"

namespace relamp {

std::filesystem::path writeComparison(const std::filesystem::path& captureFolder, const std::filesystem::path& folder,
                                      const CompareOptions& options, Progress& progress) {
    const InputFiles inputs = captureFiles(captureFolder, options.fix, progress);
    const std::filesystem::path page = folder / "index.html";
    inputs.refuse(page);
    for (const char* mode : {"near-field", "distant-only"})
        checkShotCanBeWritten(folder / (std::string(mode) + ".relamp"), inputs);
    std::error_code failed;
    std::filesystem::create_directories(folder, failed);
    if (failed) throw Error("{}: cannot be made ({})", folder.string(), failed.message());

    Comparison comparison;
    PipelineResult result;
    // Distant-only first, because memory is reported as the highest so far and it needs less.
    for (size_t m : {size_t(1), size_t(0)}) {
        result = {};
        PipelineOptions pipeline;
        pipeline.solve = options.solve;
        pipeline.solve.nearField = m == 0;
        pipeline.load.fix = options.fix;
        const double start = progress.seconds();
        result = runPipeline(captureFolder, pipeline, progress);

        ComparedMode& mode = comparison.modes[m];
        mode.name = m == 0 ? "near-field" : "distant-only";
        const ShotSource source = sourceOf(result, captureFolder, options.fix, options.quality, options.solve.seed);
        Shot& shot = mode.shot = shotOf(std::move(result.estimate), source);
        for (TimelineEntry& entry : shot.estimate.timeline) entry.seconds -= start;
        shot.resources = {progress.seconds() - start, peakMib(), availableThreads()};
        saveShot(shot, result.scene->mesh, folder / (mode.name + ".relamp"), true);
        logInfo("{}: solved in {:.1f} s, {}", mode.name, shot.resources.seconds,
                counted(shot.estimate.emitters.emitters.size(), "light"));
    }
    comparison.capture =
        std::filesystem::absolute(captureFolder / ".").lexically_normal().parent_path().filename().string();
    comparison.views = result.capture.views.size();
    comparison.vertices = result.scene->mesh.vertexCount();
    comparison.triangles = result.scene->mesh.triangles.size();
    drawComparison(result.capture, *result.scene, options.maxViews, comparison, progress);

    writeBytesAtomically(page, comparisonPage(comparison));
    for (const ComparedMode& mode : comparison.modes)
        logInfo("{}: photographs reproduced at {:.1f} dB", mode.name, mode.psnr);
    return page;
}

}  // namespace relamp
