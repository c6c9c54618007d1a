// What a solve begins with: which patches may be emitters, what the photographs say, transport, a guess of the light.
#include "solve/steps/steps.h"

namespace relamp {

void observeAnew(SolveRun& s) {
    s.observed = SolveObservations::of(s.in, s.emitters.skip(), s.gloss.noMetals, s.plan.observed.get());
    s.plan.observed.reset();
    s.light.prior.darkness = s.observed.darkness;
}

void rebuildRows(SolveRun& s) {
    if (!s.light.environmentBlack && s.light.visibility.bits.empty()) {
        s.meter.begin(Stage::visibility);
        const int level = s.light.firstLevel(s.in, s.hasMatte());
        s.light.learnVisibility(s.in, s.light.visibilityStepFor(s.in, s.hasMatte(), level));
    }
    s.meter.begin(Stage::rows);
    s.light.anchor(s.in, s.emitters);
    s.light.influence = s.light.rowsOf(s.in, s.emitters, s.observed.matte);
}

void finishVisibility(SolveRun& s) {
    if (s.light.environmentBlack || s.light.visibility.step == 1 || s.stopped()) return;
    const std::optional<Stage> stage = s.meter.current();
    s.meter.begin(Stage::visibility);
    s.light.learnVisibility(s.in, 1);
    s.meter.begin(stage);
    s.light.influence = s.light.rowsOf(s.in, s.emitters, s.observed.matte);
}

void beginSolve(SolveRun& s, const EmitterClusters& clusters) {
    if (s.in.samples.samples.empty())
        throw Error(
            "no vertex of the mesh is seen by any photograph: check the cameras' poses and the mesh's scale with "
            "`relamp check`");
    s.meter.begin(Stage::ratios);
    s.emitters = EmitterDecision::of(s.in.scene, clusters, s.in.options.nearField);
    s.light.computeNearField(s.in, s.emitters);
    observeAnew(s);
    if (s.observed.matte.vertices.empty())
        throw Error(
            "no vertex has a usable observation: every pixel on the mesh is clipped, or all of the mesh was taken for "
            "lights; `relamp check` tells which");
    LightProblem& light = s.light;
    light.environmentBlack = !s.in.choices.distantLight && !s.emitters.surfaces.empty();
    const auto coarsest = [](const LightLeaves& leaves) {
        int level = LightLeaves::maxLevel;
        for (size_t i = 0; i < leaves.size(); ++i) level = std::min(level, int(leaves[i].level));
        return level;
    };
    const int first = light.firstLevel(s.in, s.hasMatte());
    light.startsFromPlan = s.plan.light && s.in.samples.environments() == 1 && !light.environmentBlack &&
                           s.in.options.nearField && s.hasMatte() && coarsest(s.plan.light->leaves) == first &&
                           first < s.in.options.startLevel;
    light.lighting.leaves =
        light.startsFromPlan ? s.plan.light->leaves.withStates(s.in.samples.environmentOfState) : s.leavesAt(first);
    rebuildRows(s);
    light.guess(s.emitters.clusters, s.observed.matte);
    if (light.startsFromPlan) light.lighting.leafRadiance = s.plan.light->leafRadiance;
    s.plan.light.reset();
}

}  // namespace relamp
