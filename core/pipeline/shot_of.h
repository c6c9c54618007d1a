// An estimate becomes a shot: the one place where a shot is filled.
#pragma once
#include "pipeline/pipeline.h"
#include "shot/shot_file.h"

namespace relamp {

/// What a shot says of its estimate beside the estimate.
struct ShotSource {
    std::filesystem::path captureFolder;
    CaptureFix fix;   ///< how the capture's files are to be read so that they give what was solved
    DVec3 origin{0};  ///< of the capture
    std::string quality = "standard";
    uint64_t seed = 1;
    Resources resources{};
};

/// How the capture's files are to be read so that they give what was solved: as asked for, and what was put right.
CaptureFix fixOf(const Capture& solved, const Corrections& corrections, CaptureFix asked);

/// Where the result of runPipeline comes from. `asked`: how it was asked to read the capture's files.
ShotSource sourceOf(const PipelineResult& result, const std::filesystem::path& captureFolder, const CaptureFix& asked,
                    const std::string& quality, uint64_t seed);

Shot shotOf(Estimate estimate, const ShotSource& source, const Look& look = {});

}  // namespace relamp
