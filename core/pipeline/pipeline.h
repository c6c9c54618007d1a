// The conductor: the paper's pipeline from capture to estimate, one room after the other.
#pragma once
#include <filesystem>
#include <memory>

#include "base/progress.h"
#include "base/stage_meter.h"
#include "capture/load_capture.h"
#include "pipeline/plan.h"
#include "radiance/gather.h"
#include "scene/decimate.h"
#include "scene/scene.h"
#include "solve/solve.h"
#include "solve/unobserved/unobserved_light.h"

namespace relamp {

struct PipelineOptions {
    LoadOptions load;
    GatherOptions gather;
    ClusterOptions clusters;
    SolveOptions solve;
    bool everything = false;  ///< the planner leaves nothing out
    bool photometric =
        true;  ///< exposure, white balance and fall-off are taken out of the photographs where they differ clearly
    bool findLight = false;  ///< looks for an emitter that no photograph shows and puts a proxy in its place
    std::optional<size_t> meshTriangles = {};  ///< that the mesh may have in the solve (pipeline/working_mesh.h); 0: as
                                               ///< it is, none: large meshes are decimated
    bool onlyPlan = false;                     ///< stops before the solve: the estimate holds the plan alone
    /// Asked when the capture is read, before anything is computed: where an earlier solve of it stood, or nothing.
    std::function<std::optional<SolveCheckpoint>(const Capture&)> resume = {};
};

/// Products of rooms 2 to 4 for the mesh that the solve runs on.
struct Prepared {
    std::optional<DecimatedMesh> working;  ///< that mesh, where the capture's is too large
    std::shared_ptr<const Scene> scene;
    std::shared_ptr<const RadianceSamples> samples;
    EmitterClusters clusters;
};

/// Rooms 2 to 4. `scene` and `samples`, if not null, are those of the capture's own mesh, made before; they are used
/// where the solve runs on that mesh.
Prepared prepare(const Capture& capture, const PipelineOptions& options, StageMeter& meter, Progress& progress,
                 std::shared_ptr<const Scene> scene = {}, std::shared_ptr<const RadianceSamples> samples = {});

/// Plan, solve, and how well the estimate explains the photographs. `whole` is the capture's own scene; the estimate is
/// for its mesh. `planned`, if any, hears the plan. Snapshots that `listener` hears hold a quick measure of how well
/// the photographs are explained.
Estimate solvePrepared(const Capture& capture, const Scene& whole, const Prepared& prepared,
                       const PipelineOptions& options, StageMeter& meter, Progress& progress,
                       const SolveListener* listener = nullptr, const SolveCheckpoint* resume = nullptr,
                       const std::function<void(const SolvePlan&)>& planned = {});

/// Every room's product, so that the window and the reports can look at each. Where the solve ran on a decimated mesh,
/// `samples` and `clusters` are of that one, `scene` and `estimate` of the capture's.
struct PipelineResult {
    Capture capture;
    std::shared_ptr<const Scene> scene;
    std::shared_ptr<const RadianceSamples> samples;
    EmitterClusters clusters;
    Estimate estimate;
    PhotometricFix photometric;                   ///< what was taken out of the photographs of `capture`
    int smoothedNormals = 0;                      ///< rounds of smoothing that the normals of `capture` have had
    std::optional<UnobservedLightSearch> search;  ///< when it was asked for; what it found is among capture.proxies
};

/// What stands in the mesh for an emitter that was found: a sphere, small beside its distance, so that its shadows are
/// those of the point it was found as.
ProxyLight proxyOf(const UnobservedLight& light);

/// How the capture's files are to be read so that they give what was solved: as asked for, and what the pipeline found.
CaptureFix fixOf(const PipelineResult& result, CaptureFix asked);

/// What exposures, white balance and lens differ by, when the photographs agree clearly better without it; else
/// nothing, and why is logged.
PhotometricFix choosePhotometric(const Capture& capture, const Prepared& prepared, Progress& progress);

/// Throws what the rooms throw.
PipelineResult runPipeline(const std::filesystem::path& captureFolder, const PipelineOptions& options,
                           Progress& progress, const SolveListener* listener = nullptr);

}  // namespace relamp
