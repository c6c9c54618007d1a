// Does a light that is a sheet shine to its other side too? A reconstruction has no underside that no photograph shows.
#pragma once
#include "clusters/emitter_clusters.h"
#include "radiance/samples.h"
#include "scene/scene.h"
#include "solve/solve.h"

namespace relamp {

/// Part of an emitter's area, 0 to 1, behind which the mesh has no other side of it: the ray into it meets nothing, or
/// the front of something else. O(triangles rays).
float openBehind(const Scene& scene, const EmitterCluster& emitter);

/// Vertices, ascending, of the emitters and candidates that are open behind and by which photographs are explained
/// better when they shine to both sides: the misfit of the planner's pilot falls by 1 % or more and by three standard
/// errors. Fitted balls and proxies stay. Cost: two pilots for an open emitter, a second each on a mesh of 50 000
/// vertices; nothing without one. Throws Cancelled.
std::vector<uint32_t> shiningToBothSides(const Scene& scene, const RadianceSamples& samples,
                                         const EmitterClusters& clusters, const SolveOptions& options,
                                         Progress& progress);

/// Vertices, ascending, with which emitters and candidates are closed where at most one photograph shows them (a
/// reconstruction closes the opening of a shade below), if photographs are explained better when they shine too, by 0.2
/// % of the misfit and four standard errors: one of several emitters changes few pairs, and from outside an opening
/// through which one sees the shining inside is as bright as a skin over it. Asked where they are a twentieth of the
/// emitter's area. Cost: two pilots for each of these. Throws Cancelled.
std::vector<uint32_t> shiningSkins(const Scene& scene, const RadianceSamples& samples, const EmitterClusters& clusters,
                                   const SolveOptions& options, Progress& progress);

}  // namespace relamp
