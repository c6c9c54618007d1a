// Before the solve: what of the whole model this capture needs, and what every stage will cost on this machine.
#pragma once
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "base/progress.h"
#include "capture/capture.h"
#include "clusters/emitter_clusters.h"
#include "radiance/samples.h"
#include "scene/scene.h"
#include "solve/solve.h"

namespace relamp {

/// Looks at the products of rooms 1 to 4, fits coarse light to a few thousand pairs of points, times small components
/// of the work on this machine, and says what `solveScene` may leave out, why, and what that saves. `everything`:
/// nothing is left out, only costs are predicted. Cost: about half a second. Never decides on hope: what is not clearly
/// unneeded takes part, and the solve's own tests still judge it. Throws Cancelled.
SolvePlan planSolve(const Capture& capture, const Scene& scene, const RadianceSamples& samples,
                    const EmitterClusters& clusters, const SolveOptions& options, bool everything, Progress& progress);

/// The plan knows one lighting state, `part` of `all`. Its steps have as many more rows as there are more observations;
/// visibility has not.
void countAllStates(const RadianceSamples& all, const RadianceSamples& part, SolvePlan& plan);

/// `{stages: [{name, predicted_s, measured_s, predicted_mib, measured_mib}], left_out: [{what, reason, saved_s,
/// saved_mib}], predicted_s, saved_s, planning_s}`; what is not known is null.
nlohmann::json planJson(const SolvePlan& plan);
/// For people: a line a stage, a line for what is left out.
std::string planText(const SolvePlan& plan);

}  // namespace relamp
