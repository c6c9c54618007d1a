// Does mesh throw a shadow that is not there? What lies beside a bulb is often closed over by a reconstruction.
#pragma once
#include "clusters/emitter_mend.h"
#include "radiance/samples.h"
#include "scene/scene.h"
#include "solve/solve.h"

namespace relamp {

/// The scene with more triangles that light passes. O(triangles).
Scene withoutShadowOf(const Scene& scene, const std::vector<uint32_t>& triangles);

/// Triangles, ascending, that hide light though the photographs are explained better without them: those of a suspect
/// go if the misfit of the planner's pilot falls by 1 % or more and by three standard errors without it. `suspects`:
/// vertices of each. Cost: a pilot for a suspect, a second on a mesh of 50 000 vertices; nothing without suspects.
/// Throws Cancelled.
std::vector<uint32_t> falseObstacles(const Scene& scene, const RadianceSamples& samples,
                                     const EmitterClusters& emitters,
                                     const std::vector<std::vector<uint32_t>>& suspects, const SolveOptions& options,
                                     Progress& progress);

/// What a reconstruction closes behind bodies of light, and no photograph tells from them: where light passes it
/// (falseObstacles), it goes with what the body replaces. True where some does. The bodies are in the scene. Throws
/// Cancelled.
bool openBags(const Scene& scene, const RadianceSamples& samples, const EmitterClusters& emitters,
              const SolveOptions& options, std::vector<EmitterReplacement>& bodies, Progress& progress);

/// Suspects beside fitted balls. Patches that shine so brightly that the ball's light on them must explain it: a
/// reconstruction stretches a skin over the opening of a shade, and on it stands what is seen through it. Surface near
/// the ball that no photograph shows, and what lies on the ball and shines as it does: the reconstruction's own bulb.
/// Vertices from `given` on are none: mends added them, such as a stand's sleeve, for reasons of their own.
std::vector<std::vector<uint32_t>> obstacleSuspects(const Scene& scene, const RadianceSamples& samples,
                                                    const EmitterClusters& emitters, size_t given);

}  // namespace relamp
