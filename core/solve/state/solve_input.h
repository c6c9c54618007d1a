// What every step of a solve is given. Not a door.
#pragma once
#include "capture/capture.h"
#include "radiance/samples.h"
#include "scene/scene.h"
#include "solve/solve.h"

namespace relamp {

/// References to what outlives the solve. `choices` are the plan's, which a step may still narrow.
struct SolveInput {
    const Capture& capture;
    const Scene& scene;
    const RadianceSamples& samples;
    const SolveOptions& options;
    const PlanChoices& choices;
    Progress& progress;

    bool stopped() const { return progress.outOfTime(); }
};

}  // namespace relamp
