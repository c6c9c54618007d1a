// Photographs against mesh: what stands where they show the background, and emitters of another shape than they show.
#pragma once
#include "pipeline/pipeline.h"

namespace relamp {

/// Takes skirts off the capture's mesh (radiance/free_space.h), completes round sheets of which it lacks a part
/// (radiance/missing_surface.h), gives emitters the shape that their pixels show
/// (clusters/emitter_mend.h) and opens what hides them though light passes (pipeline/light_obstacles.h). What does not
/// bring mesh and photographs together is taken back. `capture` and `prepared` follow; balls of light join the
/// capture's proxies, and a note says each. Returns what was done to the file's mesh.
MeshMend mendMesh(const PipelineOptions& options, Capture& capture, Prepared& prepared, StageMeter& meter,
                  Progress& progress);

}  // namespace relamp
