// The steps in their order, and how each ends when the time is used up.
#include "base/log.h"
#include "solve/steps/steps.h"

namespace relamp {
namespace {

Stage stageOf(SolveStep step) {
    switch (step) {
        case SolveStep::firstLight:
        case SolveStep::strongLight: return Stage::coarseLight;
        case SolveStep::startLight: return Stage::light;
        case SolveStep::bounces: return Stage::bouncedLight;
        case SolveStep::lightStrength: return Stage::priorStrength;
        case SolveStep::splitStrong:
        case SolveStep::refineLight: return Stage::finerLight;
        case SolveStep::firstSurfaces: return Stage::firstSurfaces;
        case SolveStep::surfaces: return Stage::surfaces;
        case SolveStep::glossLight: return Stage::glossLight;
        case SolveStep::glossSurfaces: return Stage::glossSurfaces;
        case SolveStep::turn: return Stage::turns;
    }
    return Stage::other;
}

/// The first step of a scene that is not matte enough for ratios, or not known to be.
void startWithoutMatte(SolveRun& s) {
    if (!startFromConstantReflectance(s)) {
        // Neither metals nor quite matte: what the views have in common is taken for matte.
        observeAnew(s);
        s.light.lighting.leaves = s.leavesAt(s.light.firstLevel(s.in, s.hasMatte()));
        s.light.guess(s.emitters.clusters, s.observed.matte);
        rebuildRows(s);
    }
}

void firstStep(SolveRun& s) {
    if (!s.hasMatte()) startWithoutMatte(s);
    if (!s.hasMatte()) confirmEmitters(s);
    else if (s.in.options.nearField) coarseLight(s);
    else startFromConstantAlbedo(s);
}

/// Surfaces; where something shines, the light is fitted again with it, else it is fitted to its end now.
void surfacesStep(SolveRun& s) {
    const std::vector<uint8_t>& glossy = s.observed.matte.componentGlossy;
    if (s.in.options.glossRounds == 0 || std::none_of(glossy.begin(), glossy.end(), [](uint8_t g) { return g > 0; }))
        finishLight(s);
    solveReflectance(s);
}

void glossLightStep(SolveRun& s) {
    if (!s.gloss.empty()) {
        improveLight(s, s.in.options.refineIterations);
    } else if (s.light.unfinished) {
        finishLight(s);
        solveReflectance(s);
    }
}

/// A round of lobe and light that would change nothing: the one before found the coatings it began with. Or one behind
/// the usual ones, and no metal that it is for.
bool roundIsNotNeeded(const SolveRun& s, SolveStep step) {
    if (step != SolveStep::glossLight && step != SolveStep::glossSurfaces) return false;
    if (s.gloss.settled) return true;
    const std::vector<SolveStep> steps = stepsOf(s.in.options);
    const auto round = std::count(steps.begin(), steps.begin() + s.step, step);
    const std::vector<uint8_t>& glossy = s.observed.matte.componentGlossy;
    return round >= s.in.options.glossRounds &&
           std::none_of(glossy.begin(), glossy.end(), [](uint8_t g) { return g == 2; });
}

void doStep(SolveRun& s, SolveStep step) {
    using enum SolveStep;
    const bool ratios = s.hasMatte() && s.in.options.nearField, alternating = s.hasMatte() && !s.in.options.nearField;
    switch (step) {
        case firstLight: firstStep(s); break;
        case strongLight:
            if (ratios) sharpenStrong(s);
            break;
        case SolveStep::firstSurfaces:
            if (ratios) relamp::firstSurfaces(s);
            break;
        case SolveStep::startLight:
            // Before bounced light, whose scale follows from theirs.
            if (ratios) {
                relamp::startLight(s);
                judgePatches(s);
            }
            break;
        case bounces:
            if (ratios) decideBounce(s, false);
            break;
        case lightStrength: askLightStrength(s); break;
        case splitStrong:
            if (!refineLeaves(s)) s.light.refined = true;
            break;
        case refineLight:
            if (s.light.refined) break;
            if (alternating) alternate(s);
            else improveLight(s, s.in.options.refineIterations);
            updateBounce(s);
            break;
        case surfaces: surfacesStep(s); break;
        case glossLight: glossLightStep(s); break;
        case glossSurfaces:
            if (s.gloss.empty()) break;
            solveReflectance(s);
            updateBounce(s);
            break;
        case turn:
            if (s.hasMatte() && s.gloss.empty()) alternate(s);
            break;
    }
}

}  // namespace

void runStep(SolveRun& s, SolveStep step, uint32_t index) {
    s.meter.begin(stageOf(step));
    s.step = index;
    using enum SolveStep;
    // Without anything to show nothing is given up.
    const bool dispensable = step != firstLight && step != surfaces;
    if ((dispensable && s.stopped()) || roundIsNotNeeded(s, step)) return;
    s.stepMayBeCut = s.hasMatte() && s.in.options.nearField &&
                     (step == firstLight || step == startLight || step == refineLight || step == glossLight);
    const Lighting before = s.light.lighting;
    std::array<std::vector<Rgb>, 3> joined;  // bounced light that coarse light has
    if (step == bounces) joined = {s.bounce.atObservation, s.bounce.atVertex, s.bounce.outgoing};
    s.light.keepForCut(s.in);
    try {
        std::optional<Progress::Dispensable> mayEnd;
        if (dispensable) mayEnd.emplace(s.in.progress);
        doStep(s, step);
    } catch (const OutOfTime&) {
        // The fits keep what is best so far themselves; what stands half done here is taken back.
        if (s.light.lighting.leaves.size() == before.leaves.size() &&
            s.light.lighting.emitterRadiance.size() == before.emitterRadiance.size())
            s.light.lighting = before;
        if (!joined[0].empty())
            std::tie(s.bounce.atObservation, s.bounce.atVertex, s.bounce.outgoing) =
                std::tuple(std::move(joined[0]), std::move(joined[1]), std::move(joined[2]));
        else if (step == bounces) s.bounce.forget("the time was used up before it could be tried");
        logInfo("{}: given up, the time is used up", nameOf(stageOf(step)));
    }
    if (s.stopped()) s.light.takeBackUnfitted(s.in, s.emitters);
    s.stepMayBeCut = false;
}

void finishedStep(SolveRun& s, uint32_t next, SolveStep finished) {
    using enum SolveStep;
    if (s.listener && s.listener->checkpoint && !s.stopped()) {
        s.lastCheckpoint = s.in.progress.seconds();
        s.listener->checkpoint(checkpointOf(s, next, true));
    }
    const bool shown = finished == firstLight || finished == firstSurfaces || finished == startLight ||
                       finished == bounces || finished == surfaces || finished == glossSurfaces ||
                       (finished == refineLight && !s.light.refined);
    if (shown) showSnapshot(s);
}

}  // namespace relamp
