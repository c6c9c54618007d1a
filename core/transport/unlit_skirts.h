// Skirts before a black background: mesh that a light of the scene would light, and that photographs show black.
#pragma once
#include "base/progress.h"
#include "clusters/emitter_clusters.h"
#include "radiance/samples.h"
#include "scene/scene.h"

namespace relamp {

/// Triangles that stand where no surface is, ascending. A black background looks the same from everywhere, so that
/// radiance/free_space.h cannot tell it from a dark surface. A light can: what it lights without shadow, and what shows
/// less than an albedo of 1 % would from everywhere, is none. Regions of such vertices go that
/// - reach a rim of the mesh,
/// - have 30 vertices at more than three edges from a surface that shows something: nearer, shadows may lie elsewhere,
/// - end at surfaces that are not dark as well, as under a light that is directed.
/// Nothing where the background is not black, no light is known, or there are several lighting states. `leftOut`, per
/// vertex (non-zero: lights, mirrors): not asked. Cost: computeNearField's. Throws Cancelled.
std::vector<uint32_t> unlitSkirts(const Scene& scene, const RadianceSamples& samples, const EmitterClusters& clusters,
                                  const std::vector<uint8_t>& leftOut, Progress& progress);

}  // namespace relamp
