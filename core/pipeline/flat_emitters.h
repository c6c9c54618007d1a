// Flat emitters that stand off a surface, such as a screen on a wall: a reconstruction makes them a bump of it.
#pragma once
#include "clusters/emitter_mend.h"

namespace relamp {

/// Fronts of flat emitters that the mesh has at another depth than their outlines say, by two standard deviations and
/// more (solve/registration/flat_outline.h). The front's vertices move along its normal, and those between it and the
/// surface behind in proportion. A bump of half the height hides a third of the light that a screen sends along its
/// wall. O(pixels x emitters).
std::vector<EmitterMove> liftedFronts(const Scene& scene, const Capture& capture, const RadianceSamples& samples,
                                      const EmitterClusters& clusters);

}  // namespace relamp
