// What was moved with an emitter shines as it does.
#pragma once
#include "capture/mesh_mend.h"
#include "clusters/emitter_clusters.h"

namespace relamp {

/// Gives emitters the moved vertices that are connected with theirs by others, where most of these were theirs already:
/// photographs look along the sides of a screen that was brought to its outlines (pipeline/flat_emitters.h), and few of
/// their pixels tell. Rims of shades are no emitter's. O(triangles).
void shineAsMoved(const Scene& scene, const std::vector<MeshMend::MovedVertex>& moved, EmitterClusters& clusters);

}  // namespace relamp
