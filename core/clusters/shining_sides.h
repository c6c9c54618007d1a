// Sides of emitters that photographs look along, so that few pixels show them.
#pragma once
#include "clusters/emitter_clusters.h"

namespace relamp {

/// Gives emitters those of the vertices `shining` (MeshMend::shining) that are connected with theirs, by others of
/// them, and the triangles between. Fitted balls and proxies stay. O(triangles x emitters).
void letSidesShine(const Scene& scene, const std::vector<uint32_t>& shining, EmitterClusters& clusters);

}  // namespace relamp
