// What of a surface one emitter is: its hidden rest, and not the emitters like it elsewhere. Inner part of the
// clusters, not a door.
#pragma once
#include "clusters/patches.h"

namespace relamp {

/// Vertices of a patch in the groups that lie apart: between two groups' boxes is more than half the larger box's
/// diagonal. A reconstruction is one component, and holds emitters that are alike.
std::vector<std::vector<uint32_t>> partsApart(const Scene& scene, const std::vector<uint32_t>& vertices);

/// Largest channel that photographs show of vertices without an observation, and of three pixels around; the median
/// over the views. Below 0: fewer than two views show it, or it has observations. A thin stand below a shade has none,
/// because edges are near everywhere. O(such vertices x views).
std::vector<float> glimpsesOf(const Scene& scene, const Capture& capture, const RadianceSamples& samples,
                              const std::vector<VertexRadiance>& seen);

/// Lets a patch take the unobserved and half-seen rest of its own part. Vertices marked in `ofOthers` stay there, and
/// so does what `glimpses` show less than a quarter as bright as the darkest twentieth of it.
void complete(const Scene& scene, const std::vector<VertexRadiance>& seen, const std::vector<float>& glimpses,
              const std::vector<uint8_t>& ofOthers, EmitterCluster& cluster);

}  // namespace relamp
