#include "solve/solve_plan.h"

#include <algorithm>

namespace relamp {

PlannedStage& SolvePlan::stage(const std::string& name) {
    const auto at = std::find_if(stages.begin(), stages.end(), [&](const PlannedStage& s) { return s.name == name; });
    if (at != stages.end()) return *at;
    stages.push_back({name, -1, -1, -1, -1});
    return stages.back();
}

double SolvePlan::predictedSeconds() const {
    double sum = 0;
    for (const PlannedStage& s : stages) sum += std::max(0.0, s.predictedSeconds);
    return sum;
}

double SolvePlan::savedSeconds() const {
    double sum = 0;
    for (const PlannedOmission& o : leftOut) sum += o.savedSeconds;
    return sum;
}

}  // namespace relamp
