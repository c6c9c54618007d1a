// Are the mesh's normals too noisy to shade with? The photographs say: a coarse light explains ratios of radiance better or worse with smoother ones.
#pragma once
#include "clusters/emitter_clusters.h"
#include "radiance/samples.h"
#include "scene/scene.h"
#include "solve/solve.h"

namespace relamp {

struct NormalsChoice {
    int rounds = 0;        ///< of smoothedNormals; 0: the normals stay
    double better = 0;     ///< share of the misfit of some thousand pairs that goes away
};

/// Tries 2 rounds, and 6 where those help, on the planner's pilot. Smoother normals are taken where the misfit falls by 1.5 % or more and by four standard errors: real detail
/// lost makes it rise. Meshes of which half of the normals turn by less than 0.02 are left alone without asking. Cost otherwise: one or two coarse fits, about half a second on a mesh of 30000 vertices. Throws Cancelled.
NormalsChoice chooseNormals(const Scene& scene, const RadianceSamples& samples, const EmitterClusters& lamps, const SolveOptions& options, Progress& progress);

}  // namespace relamp
