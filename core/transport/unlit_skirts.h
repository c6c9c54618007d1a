// Skirts before a black background: mesh that a light of the scene would light, and that photographs show black.
#pragma once
#include "base/progress.h"
#include "clusters/emitter_clusters.h"
#include "radiance/samples.h"
#include "scene/scene.h"

namespace relamp {

/// Triangles that stand where no surface is, ascending. A black background looks the same from everywhere, so that
/// radiance/free_space.h cannot tell it from a dark surface; a light can: what it lights without shadow and still shows
/// less than an albedo of 1 % from everywhere is none. Regions of such vertices that reach a rim of the mesh, without
/// what lies within three edges of a surface that shows something, where shadows may lie a little elsewhere; and where
/// surfaces beside them are not dark as well, as under a light that is directed. Nothing where the background is not
/// black, where no light is known, and in captures of several lighting states. `leftOut`, per vertex (non-zero: lights,
/// mirrors): not asked. Cost: computeNearField's. Throws Cancelled.
std::vector<uint32_t> unlitSkirts(const Scene& scene, const RadianceSamples& samples, const EmitterClusters& clusters,
                                  const std::vector<uint8_t>& leftOut, Progress& progress);

}  // namespace relamp
