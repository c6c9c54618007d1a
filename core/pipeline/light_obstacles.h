// Does mesh throw a shadow that is not there? What lies beside a bulb is often closed over by a reconstruction.
#pragma once
#include "clusters/emitter_clusters.h"
#include "radiance/samples.h"
#include "scene/scene.h"
#include "solve/solve.h"

namespace relamp {

/// Triangles, ascending, that hide a fitted ball's light though the photographs are explained better without them.
/// Suspect are patches beside the ball that shine so brightly that its light on them must explain it: a reconstruction
/// stretches a skin over the opening of a shade, and on it stands what is seen through it. Each goes if the misfit of
/// the planner's pilot falls by 1 % or more and by three standard errors without it. So do surface near the ball that
/// no photograph shows, and what lies on the ball and shines as it does: the reconstruction's own bulb. Cost: a pilot
/// for a suspect, a second on a mesh of 50 000 vertices; nothing without suspects. Throws Cancelled.
std::vector<uint32_t> falseObstacles(const Scene& scene, const RadianceSamples& samples,
                                     const EmitterClusters& emitters, const SolveOptions& options, Progress& progress);

/// The vertices of each suspect.
std::vector<std::vector<uint32_t>> obstacleSuspects(const Scene& scene, const RadianceSamples& samples,
                                                    const EmitterClusters& emitters);

}  // namespace relamp
