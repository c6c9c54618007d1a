// How long a running solve will take yet.
#pragma once
#include "solve/solve_plan.h"

namespace relamp {

/// Seconds to come. `plan` is that of the solve, with what its stages have cost so far; its latest figure is `since`
/// seconds old. What has been measured corrects what is predicted: where stages took twice as long, so will the others.
double secondsLeft(const SolvePlan& plan, double since);

}  // namespace relamp
