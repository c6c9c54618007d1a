// The conductor: the paper's pipeline from capture to estimate, one room after the other.
#pragma once
#include <filesystem>

#include "base/progress.h"
#include "capture/load_capture.h"
#include "pipeline/plan.h"
#include "radiance/gather.h"
#include "scene/scene.h"
#include "solve/hidden_light.h"
#include "solve/solve.h"

namespace relamp {

struct PipelineOptions {
    LoadOptions load;
    GatherOptions gather;
    ClusterOptions clusters;
    SolveOptions solve;
    bool everything = false;   ///< the planner leaves nothing out
    bool findLight = false;    ///< looks for a lamp that no photograph shows and puts a proxy in its place
    std::optional<size_t> meshTriangles = {};  ///< that the mesh may have in the solve (pipeline/working_mesh.h); 0: as it is, none: large meshes are decimated
    bool onlyPlan = false;     ///< stops before the solve: the estimate holds the plan alone
    /// Asked when the capture is read, before anything is computed: where an earlier solve of it stood, or nothing.
    std::function<std::optional<SolveCheckpoint>(const Capture&)> resume = {};
};

/// Every room's product, so that the window and the reports can look at each. Where the solve ran on a decimated mesh, `samples` and `clusters` are of that
/// one, `scene` and `estimate` of the capture's.
struct PipelineResult {
    Capture capture;
    Scene scene;
    RadianceSamples samples;
    EmitterClusters clusters;
    Estimate estimate;
    int smoothedNormals = 0;   ///< rounds of smoothing that the normals of `capture` have had
    std::optional<HiddenLightSearch> search;   ///< when it was asked for; what it found is among capture.proxies
};

/// What stands in the mesh for a lamp that was found: a sphere, small beside its distance, so that its shadows are those of the point it was found as.
ProxyLight proxyOf(const HiddenLight& light);

/// Throws what the rooms throw.
PipelineResult runPipeline(const std::filesystem::path& captureFolder, const PipelineOptions& options, Progress& progress, const SolveListener* listener = nullptr);

}  // namespace relamp
