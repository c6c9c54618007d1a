// The cost model: counts of rays, rows, leaves, observations and vertices times what one of each takes on this machine.
// Not a door.
#pragma once
#include "pipeline/machine_speed.h"
#include "pipeline/plan_pilot.h"
#include "solve/solve.h"

namespace relamp {

/// What a solve will meet.
struct WorkCounts {
    double vertices = 0, seen = 0;  ///< of the mesh; those that a photograph shows
    double rows = 0, pairs = 0;     ///< matte observations, and pairs of them
    double emitters = 0;
    double litColumnFraction = 1;
    double glossyObservations = 0,
           matteObservations =
               0;      ///< that lobes would be fitted to, on components that change with the view and on the others
    double lobes = 0;  ///< of the basis, without Lambert
    double observationSeconds = 0;  ///< one row of one lobe
    bool matte = true;              ///< the scene has a matte signal
    bool lobeLikely = true;         ///< some lobe will be found
    bool metals = false;            ///< some components have no matte part
};

struct StageEstimate {
    Stage stage = Stage::other;
    double seconds = 0, mib = 0;
};

/// The stages of solveScene under `choices`. `bounceKept`: as far as the pilot can tell.
std::vector<StageEstimate> predictStages(const WorkCounts& counts, const MachineSpeed& speed,
                                         const PilotFindings& pilot, const SolveOptions& options,
                                         const PlanChoices& choices);

}  // namespace relamp
