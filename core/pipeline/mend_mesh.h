// Photographs against mesh: what stands where they show the background, and emitters of another shape than they show.
#pragma once
#include "pipeline/pipeline.h"

namespace relamp {

/// Takes skirts off the capture's mesh (radiance/free_space.h), gives slabs their edges and sides
/// (radiance/slab_sides.h), completes round sheets of which it lacks a part
/// (radiance/round_sheets.h), gives emitters the shape that their pixels show (clusters/emitter_mend.h) and opens
/// shades (pipeline/light_obstacles.h, radiance/back_sides.h). What does not bring mesh and photographs together is
/// taken back. A mesh without skirts that registration left as it is (`moved`: it did not) has no missing sheets.
/// `capture` and `prepared` follow; balls of light join the capture's proxies, and a note says each. Returns what was
/// done to the file's mesh.
MeshMend mendMesh(const PipelineOptions& options, Capture& capture, Prepared& prepared, bool moved, StageMeter& meter,
                  Progress& progress);

/// Per vertex 1 where one of these clusters lies.
std::vector<uint8_t> verticesOf(const Scene& scene, std::initializer_list<const std::vector<EmitterCluster>*> lists);

}  // namespace relamp
