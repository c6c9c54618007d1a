#include "solve/steps/solve_run.h"

#include "solve/steps/steps.h"

namespace relamp {

SolveRun::SolveRun(const Capture& capture, const Scene& scene, const RadianceSamples& samples,
                   const SolveOptions& options, Progress& progress, const SolveListener* hears)
    : plan(options.plan),
      in{capture, scene, samples, options, plan.choices, progress},
      listener(hears),
      meter(progress) {
    const auto strength = [](float told) { return told > 0 ? PriorStrength{told, "artist"} : PriorStrength{}; };
    light.takeStrength(strength(options.lightSmoothness));
    surfaces.take(strength(options.albedoSmoothness), options.prior);
}

LobeRowOptions SolveRun::rowOptions() const {
    LobeRowOptions options;
    options.seed = in.options.seed;
    options.shape = light.leafShape.empty() ? nullptr : &light.leafShape;
    options.shapeGrid = in.samples.backgroundGrid;
    options.outgoing = bounce.outgoing.empty() ? nullptr : &bounce.outgoing;
    options.levels = emitters.levels.empty() ? nullptr : &emitters.levels;
    return options;
}

void SolveRun::record(const std::string& stage, int iteration, double objective, double rmse) {
    timeline.push_back({in.progress.seconds(), stage, iteration, objective, rmse});
    if (listener && listener->entry) listener->entry(timeline.back());
    if (!stepMayBeCut || !listener || !listener->checkpoint ||
        in.progress.seconds() - lastCheckpoint < listener->checkpointSeconds)
        return;
    lastCheckpoint = in.progress.seconds();
    listener->checkpoint(checkpointOf(*this, step, false));
}

SolvePlan SolveRun::measuredPlan() const {
    SolvePlan measured = plan;
    for (const StageCost& cost : meter.stages()) {
        const bool foreseen = std::any_of(measured.stages.begin(), measured.stages.end(),
                                          [&](const PlannedStage& s) { return s.stage == cost.stage; });
        if (!foreseen && cost.seconds < 1e-3) continue;  // a step with nothing to do
        PlannedStage& stage = measured.stage(cost.stage);
        stage.measuredSeconds = std::max(0.0, stage.measuredSeconds) + cost.seconds;
        stage.measuredMib = std::max(stage.measuredMib, cost.mib);
    }
    return measured;
}

}  // namespace relamp
