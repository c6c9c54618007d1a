#include "solve/solve_plan.h"

#include <algorithm>

namespace relamp {

PlannedOmission::PlannedOmission(Omission part, std::string because, double seconds, double mib)
    : what(part), reason(std::move(because)), savedSeconds(seconds), savedMib(mib) {}

PlannedOmission::PlannedOmission(const std::string& name, std::string because, double seconds, double mib)
    : PlannedOmission(omissionNamed(name), std::move(because), seconds, mib) {}

PlannedStage& SolvePlan::stage(Stage which) {
    const auto at = std::find_if(stages.begin(), stages.end(), [&](const PlannedStage& s) { return s.stage == which; });
    if (at != stages.end()) return *at;
    stages.push_back({which, -1, -1, -1, -1});
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
