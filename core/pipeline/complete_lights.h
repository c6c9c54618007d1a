// Lights of which the mesh has a part, as whole bodies, as far as their light on the surfaces says.
#pragma once
#include "clusters/emitter_mend.h"
#include "clusters/partial_lights.h"
#include "solve/solve.h"

namespace relamp {

/// Lights of which the mesh has a part (partialLights), as bodies that go on beyond what photographs show by as much as
/// explains the surfaces' light best. Photographs must show more of it than the mesh has, or the misfit of the
/// planner's pilot must fall by 1 % and three standard errors against the mesh as it is; for a candidate it must fall
/// so against no light there, too. What of the mesh each replaces is in the scene's numbers. Cost: 3 to 20 pilots for a
/// light, a third of a second each on a mesh of 50 000 vertices; nothing without one. Throws Cancelled.
std::vector<EmitterReplacement> completedLights(const Scene& scene, const Capture& capture,
                                                const RadianceSamples& samples, const EmitterClusters& clusters,
                                                const SolveOptions& options, Progress& progress);

}  // namespace relamp
