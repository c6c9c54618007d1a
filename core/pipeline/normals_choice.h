// Are the mesh's normals too noisy to shade with? The photographs say: a coarse light explains ratios of radiance
// better or worse with smoother ones.
#pragma once
#include "clusters/emitter_clusters.h"
#include "radiance/samples.h"
#include "scene/scene.h"
#include "solve/solve.h"

namespace relamp {

struct NormalsChoice {
    int rounds = 0;     ///< of smoothedNormals; 0: the normals stay
    double better = 0;  ///< fraction of the misfit of some thousand pairs that goes away
};

/// Half of the normals or more turn by 0.02 or more when they are averaged over their neighbours.
bool normalsLookNoisy(const Scene& scene);

/// Tries 2 rounds, and 6 where those help, on the planner's pilot. Smoother normals are taken where the misfit falls
/// by 1.5 % or more and by four standard errors: real detail lost makes it rise. Meshes that do not look noisy are left
/// alone without asking. Cost otherwise: one or two coarse fits, about half a second on a mesh of 30000 vertices.
/// Throws Cancelled.
NormalsChoice chooseNormals(const Scene& scene, const RadianceSamples& samples, const EmitterClusters& emitters,
                            const SolveOptions& options, Progress& progress);

}  // namespace relamp
