#include "pipeline/shot_of.h"

namespace relamp {

CaptureFix fixOf(const Capture& solved, const Corrections& corrections, CaptureFix asked) {
    asked.smoothNormals = corrections.smoothedNormals;
    asked.registration = corrections.registration;
    asked.photometric = corrections.photometric;
    asked.mend = corrections.mend;
    asked.proxies = solved.proxies;
    for (ProxyLight& p : asked.proxies) p.centre += solved.origin;
    return asked;
}

ShotSource sourceOf(const PipelineResult& result, const std::filesystem::path& captureFolder, const CaptureFix& asked,
                    const std::string& quality, uint64_t seed) {
    ShotSource source;
    source.captureFolder = captureFolder;
    source.fix = fixOf(result.capture, result.corrections, asked);
    source.origin = result.capture.origin;
    source.quality = quality;
    source.seed = seed;
    return source;
}

Shot shotOf(Estimate estimate, const ShotSource& source, const Look& look) {
    Shot shot;
    shot.captureFolder = source.captureFolder;
    shot.fix = source.fix;
    shot.capture.origin = source.origin;
    shot.estimate = std::move(estimate);
    shot.look = look;
    shot.quality = source.quality;
    shot.seed = source.seed;
    shot.resources = source.resources;
    return shot;
}

}  // namespace relamp
