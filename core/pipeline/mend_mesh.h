// Photographs against mesh: what stands where they show the background, and emitters of another shape than they show.
#pragma once
#include "pipeline/pipeline.h"

namespace relamp {

/// Parts thin sheets whose sides have crossed (radiance/crossed_sheets.h), takes skirts off the capture's mesh
/// (radiance/free_space.h, transport/unlit_skirts.h), gives slabs their edges and sides (radiance/slab_sides.h),
/// completes round sheets of which it lacks a part (radiance/round_sheets.h), sharpens creases (scene/sharp_creases.h),
/// brings balls that mirror onto their spheres (radiance/mirror_spheres.h), gives emitters the shape that their pixels
/// show (clusters/emitter_mend.h), opens shades (pipeline/light_obstacles.h, radiance/back_sides.h) and adds thin parts
/// that the mesh has lost (radiance/missing_parts.h).
/// What does not bring mesh and photographs together is taken back. `shape`: where registration put the mesh's vertices
/// before it moved outlines; empty where it left the mesh as it is, which then has no missing sheets and no rounded
/// creases unless it has skirts. `capture` and `prepared` follow; balls of light join the capture's proxies, and a note
/// says each. Returns what was done to the file's mesh.
MeshMend mendMesh(const PipelineOptions& options, Capture& capture, Prepared& prepared, const std::vector<Vec3>& shape,
                  StageMeter& meter, Progress& progress);

/// Per vertex 1 where one of these clusters lies.
std::vector<uint8_t> verticesOf(const Scene& scene, std::initializer_list<const std::vector<EmitterCluster>*> lists);

}  // namespace relamp
