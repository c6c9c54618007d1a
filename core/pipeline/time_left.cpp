#include "pipeline/time_left.h"

#include <algorithm>

namespace relamp {
namespace {

/// Stages that take turns: the second does not end the first.
bool takesTurns(Stage stage) { return stage == Stage::glossLight || stage == Stage::glossSurfaces; }

}  // namespace

double secondsLeft(const SolvePlan& plan, double since) {
    // The plan lists the stages in the order in which they run; those that nobody foresaw come behind and do not count.
    size_t running = 0;
    for (size_t i = 0; i < plan.stages.size(); ++i)
        if (plan.stages[i].predictedSeconds >= 0 && plan.stages[i].measuredSeconds > 0) running = i;
    double measured = 0, foreseen = 0, toCome = 0;
    for (size_t i = 0; i < plan.stages.size(); ++i) {
        const PlannedStage& s = plan.stages[i];
        if (s.predictedSeconds < 0) continue;
        const double took = std::max(0.0, s.measuredSeconds);
        const bool over = i < running && !(takesTurns(s.stage) && takesTurns(plan.stages[running].stage));
        measured += took;
        // Of a stage that is not over only as much as has been done tells how well it was predicted.
        foreseen += over ? s.predictedSeconds : std::min(took, s.predictedSeconds);
        if (!over) toCome += std::max(0.0, s.predictedSeconds - took);
    }
    // Five seconds' worth of trust in the prediction.
    const double pace = std::clamp((measured + 5) / (foreseen + 5), 0.25, 4.0);
    return std::max(0.0, pace * toCome - since);
}

}  // namespace relamp
