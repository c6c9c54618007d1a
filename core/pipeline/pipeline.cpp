#include "pipeline/pipeline.h"

namespace relamp {

PipelineResult runPipeline(const std::filesystem::path& captureFolder, const PipelineOptions& options, Progress& progress) {
    PipelineResult r;
    // Photographs, cameras, mesh.
    r.capture = loadCapture(captureFolder, options.load, progress);
    r.scene = buildScene(r.capture.mesh, progress);
    // What the photographs say of each vertex and of the environment.
    r.samples = gatherRadiance(r.capture, r.scene, options.gather, progress);
    // High-radiance components become emitting patches ([Put15] 3.3).
    r.clusters = clusterEmitters(r.scene, r.capture, r.samples, options.clusters, progress);
    // Transport (visibility, near-field maps) and the two alternating programs: light (equations 3 to 6) and reflectance.
    r.estimate = solveScene(r.capture, r.scene, r.samples, r.clusters, options.solve, progress);
    return r;
}

}  // namespace relamp
