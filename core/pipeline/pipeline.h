// The conductor: the paper's pipeline from capture to estimate, one room after the other.
#pragma once
#include <filesystem>

#include "base/progress.h"
#include "capture/load_capture.h"
#include "radiance/gather.h"
#include "scene/scene.h"
#include "solve/solve.h"

namespace relamp {

struct PipelineOptions {
    LoadOptions load;
    GatherOptions gather;
    ClusterOptions clusters;
    SolveOptions solve;
};

/// Every room's product, so that the window and the reports can look at each.
struct PipelineResult {
    Capture capture;
    Scene scene;
    RadianceSamples samples;
    EmitterClusters clusters;
    Estimate estimate;
};

/// Throws what the rooms throw.
PipelineResult runPipeline(const std::filesystem::path& captureFolder, const PipelineOptions& options, Progress& progress);

}  // namespace relamp
