// Flat emitters that stand off a surface, such as a screen on a wall: a reconstruction makes them a bump of it.
#pragma once
#include "clusters/emitter_mend.h"

namespace relamp {

/// Moves of flat emitters before a surface whose outlines tell their depth (solve/registration/flat_outline.h) to a
/// third of their height or better. The front goes there along its normal, what lies between it and the surface goes
/// with it in proportion, and the rim goes to the outline. A low, rounded bump sends the wall beside it too little of a
/// screen's light. Emitters that shine to both sides, proxies and fitted balls stay. O(pixels x emitters).
std::vector<EmitterMove> liftedFronts(const Scene& scene, const Capture& capture, const RadianceSamples& samples,
                                      const EmitterClusters& clusters);

/// Those of emitters that no body of `found` replaces, in place of what it moves of them otherwise.
void liftFronts(const Scene& scene, const Capture& capture, const RadianceSamples& samples,
                const EmitterClusters& clusters, EmitterMend& found);

}  // namespace relamp
