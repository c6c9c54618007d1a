// Relief that a reconstruction has smoothed away turns normals, and its shading would become colour of the surface. The
// hues of the light tell such normals.
#pragma once
#include <string>
#include <vector>

#include "capture/mesh_mend.h"
#include "capture/registration_fix.h"
#include "clusters/emitter_clusters.h"
#include "radiance/samples.h"
#include "scene/scene.h"
#include "solve/solve.h"

namespace relamp {

struct LeantNormals {
    std::vector<MeshMend::TurnedVertex> turned;  ///< ascending; empty: normals stay
    std::string words;
};

/// Vertices whose normals are known: those on flat surfaces and beside creases, and all but the first `own`.
std::vector<uint8_t> knownNormals(const Scene& scene, size_t own, const RegistrationFix& fix, const MeshMend& mend);

/// Leans normals to where the hues of a coarse light show them (solve/registration/hue_normals). The photographs' own
/// brightness, of which the leans know nothing, is asked: they are taken where green albedo, which hues alone do not
/// tell, differs 2 % less between neighbours (six standard errors of a bent square), and about each vertex where it
/// differs less there. `still`: vertices that do not lean. For meshes that are known to be off. Cost: the planner's
/// pilot and three times the light of all vertices with 256 directions, 2 to 4 s. Throws Cancelled.
LeantNormals leanNormals(const Scene& scene, const RadianceSamples& samples, const EmitterClusters& clusters,
                         const std::vector<uint8_t>& still, const SolveOptions& options, Progress& progress);

}  // namespace relamp
