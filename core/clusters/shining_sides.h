// Sides of emitters that few pixels show, because photographs look along them, or none.
#pragma once
#include "clusters/emitter_clusters.h"

namespace relamp {

/// Gives emitters and candidates those of the vertices `shining` (MeshMend::shining) that are connected with theirs, by
/// others of them, and the triangles between. Fitted balls and proxies stay. O(triangles x emitters).
void letSidesShine(const Scene& scene, const std::vector<uint32_t>& shining, EmitterClusters& clusters);

/// Makes those emitters and candidates two-sided of which most vertices are in `bothSides` (MeshMend), ascending.
/// Fitted balls and proxies stay. O(vertices of emitters).
void letBacksShine(const std::vector<uint32_t>& bothSides, EmitterClusters& clusters);

}  // namespace relamp
