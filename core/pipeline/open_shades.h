// Is a shade that shines open at its ends? From outside the shining inside is as bright as an end that shines.
#pragma once
#include "clusters/emitter_mend.h"
#include "radiance/samples.h"
#include "scene/scene.h"
#include "solve/solve.h"

namespace relamp {

/// Opens tubes and cones of light: sheets that shine to both sides and let light pass. A cone is a lampshade, which is
/// open unless the misfit of the planner's pilot is higher by 1 % or more and by three standard errors then; a tube is
/// closed unless it is lower by 0.2 % or more and by four. Asked where the narrower end is 0.4 times as wide as the
/// body is long, and none is dark. `bodies` are in the scene; true where one is open then. Cost: a pilot and
/// one for each that is asked, a second each on a mesh of 50 000 vertices. Throws Cancelled.
bool openShadeEnds(const Scene& scene, const RadianceSamples& samples, const EmitterClusters& clusters,
                   const SolveOptions& options, std::vector<EmitterReplacement>& bodies, Progress& progress);

}  // namespace relamp
