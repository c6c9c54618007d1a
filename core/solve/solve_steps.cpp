// The steps of a solve, how each ends when the time is used up, and how a solve is put aside and gone on with.
#include "base/log.h"
#include "solve/solve_state.h"

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

/// A checkpoint names measured lobes; their tables are the basis's.
void findMeasured(Lobe& lobe, const BrdfBasis& basis) {
    for (Lobe& part : lobe.parts) findMeasured(part, basis);
    if (lobe.kind != Lobe::Kind::measured) return;
    const auto at = std::find_if(basis.lobes.begin(), basis.lobes.end(),
                                 [&](const Lobe& l) { return l.measured && l.name == lobe.name; });
    if (at == basis.lobes.end())
        throw Error("the checkpoint names the measured material {}, which is not in the basis", lobe.name);
    lobe.measured = at->measured;
}

}  // namespace

void SolveState::run(SolveStep step, uint32_t index) {
    meter_.begin(stageOf(step));
    step_ = index;
    using enum SolveStep;
    // Without anything to show nothing is given up.
    const bool dispensable = step != firstLight && step != surfaces;
    if (dispensable && stopped()) return;
    stepMayBeCut_ = hasMatte() && options_.nearField &&
                    (step == firstLight || step == startLight || step == refineLight || step == glossLight);
    const Lighting before = lighting_;
    std::array<std::vector<Rgb>, 3> joined;  // bounced light that coarse light has
    if (step == bounces) joined = {bounce_, vertexBounce_, outgoing_};
    keepForCut();
    try {
        std::optional<Progress::Dispensable> mayEnd;
        if (dispensable) mayEnd.emplace(progress_);
        const bool alternating = !options_.nearField && hasMatte();
        switch (step) {
            case firstLight:
                if (!hasMatte() && !startFromConstantReflectance()) {
                    // Neither metals nor quite matte: what the views have in common is taken for matte.
                    rebuildNearField();
                    lighting_.leaves = LightLeaves::uniform(firstLevel(), scene_.axes);
                    guessLight();
                    rebuildRows();
                }
                if (!hasMatte()) {
                    confirmEmitters();
                } else if (options_.nearField) {
                    this->firstLight();
                } else {
                    startFromConstantAlbedo();
                }
                break;
            case strongLight:
                if (hasMatte() && options_.nearField) sharpenStrong();
                break;
            case firstSurfaces:
                if (hasMatte() && options_.nearField) this->firstSurfaces();
                break;
            case startLight:
                if (hasMatte() && options_.nearField) this->startLight();
                break;
            case bounces:
                if (hasMatte() && options_.nearField) decideBounce(false);
                break;
            case lightStrength: askLightStrength(); break;
            case splitStrong:
                if (!refineLeaves()) refined_ = true;
                break;
            case refineLight:
                if (refined_) break;
                if (alternating) alternate();
                else improveLight(options_.refineIterations);
                updateBounce();
                break;
            case surfaces:
                // Where something shines, the light is fitted again with it.
                if (options_.glossRounds == 0 ||
                    std::none_of(matte_.componentGlossy.begin(), matte_.componentGlossy.end(),
                                 [](uint8_t g) { return g > 0; }))
                    finishLight();
                solveReflectance();
                break;
            case glossLight:
                if (hasGloss()) {
                    improveLight(options_.refineIterations);
                } else if (lightUnfinished_) {
                    finishLight();
                    solveReflectance();
                }
                break;
            case glossSurfaces:
                if (!hasGloss()) break;
                solveReflectance();
                updateBounce();
                break;
            case turn:
                if (hasMatte() && !hasGloss()) alternate();
                break;
        }
    } catch (const OutOfTime&) {
        // The fits keep what is best so far themselves; what stands half done here is taken back.
        if (lighting_.leaves.size() == before.leaves.size() &&
            lighting_.emitterRadiance.size() == before.emitterRadiance.size())
            lighting_ = before;
        if (!joined[0].empty())
            std::tie(bounce_, vertexBounce_, outgoing_) =
                std::tuple(std::move(joined[0]), std::move(joined[1]), std::move(joined[2]));
        else if (step == bounces) forgetBounce("the time was used up before it could be tried");
        logInfo("{}: given up, the time is used up", nameOf(stageOf(step)));
    }
    if (stopped()) takeBackUntold();
    stepMayBeCut_ = false;
}

void SolveState::keepForCut() {
    if (progress_.hasBudget()) untold_ = BeforeSplit{lighting_, influence_, information_};
}

void SolveState::takeBackUntold() {
    const bool told = size_t(information_.all.rows()) == 3 * influence_.columns && !information_.all.isZero(0);
    if (environmentBlack_ || told || lighting_.leaves.size() == untold_.lighting.leaves.size() ||
        lighting_.emitterRadiance.size() != untold_.lighting.emitterRadiance.size())
        return;
    lighting_ = std::move(untold_.lighting);
    influence_ = std::move(untold_.influence);
    information_ = std::move(untold_.information);
    anchorLight();
    shapeLeaves();
}

void SolveState::finishedStep(uint32_t next, SolveStep finished) {
    using enum SolveStep;
    if (listener_ && listener_->checkpoint && !stopped()) {
        lastCheckpoint_ = progress_.seconds();
        listener_->checkpoint(checkpoint(next, true));
    }
    const bool shown = finished == firstLight || finished == firstSurfaces || finished == startLight ||
                       finished == bounces || finished == surfaces || finished == glossSurfaces ||
                       (finished == refineLight && !refined_);
    if (shown) showSnapshot();
}

SolveCheckpoint SolveState::checkpoint(uint32_t step, bool between) const {
    SolveCheckpoint c;
    c.step = step;
    c.between = between;
    c.seconds = progress_.seconds();
    c.clusters = clusters_;
    c.suspect = suspect_;
    for (size_t i = 0; i < lighting_.leaves.size(); ++i) c.leaves.push_back(lighting_.leaves[i]);
    c.leafRadiance = lighting_.leafRadiance;
    c.emitterRadiance = lighting_.emitterRadiance;
    c.environmentBlack = environmentBlack_;
    c.refined = refined_;
    c.visibilityStep = visibility_.bits.empty() ? 0 : uint32_t(visibility_.step);
    c.refinedMisfit = refinedMisfit_;
    c.bounceKept = bounceRays_.rays > 0;
    c.bouncedFraction = bouncedFraction_;
    c.noBounceBecause = noBounceBecause_;
    c.noMetals = noMetals_;
    c.backgroundRefuted = backgroundRefuted_;
    c.vertexBounce = vertexBounce_;
    c.outgoing = outgoing_;
    c.lightSmoothness = lightSmoothness_;
    c.albedoSmoothness = albedoSmoothness_;
    if (!matteSeen_.vertices.empty()) {
        c.matteRadiance = matte_.radiance;
        c.matteSigma = matte_.sigma;
    }
    c.gloss = gloss_;
    c.firstGloss = firstGloss_;
    c.metalsHeard = metalsHeard_;
    c.metalsJoined = metalsJoined_;
    c.lightUnfinished = lightUnfinished_;
    for (Eigen::Index j = 0; j < information_.all.cols(); ++j)
        c.information.insert(c.information.end(), information_.all.col(j).data() + j,
                             information_.all.col(j).data() + information_.all.rows());
    for (size_t k = 0; k < 3; ++k) {
        const Eigen::MatrixXd& observations = information_.observations[k];
        const Eigen::VectorXd& seen = information_.seen[k];
        c.informationOfObservations[k].assign(observations.data(), observations.data() + observations.size());
        c.informationSeen[k].assign(seen.data(), seen.data() + seen.size());
    }
    c.albedo = albedo_.albedo;
    c.palette = palette_.colours;
    c.confidence = albedo_.confidence;
    c.timeline = timeline_;
    c.kktResidual = stability_.kktResidual;
    c.plan = measuredPlan();
    return c;
}

void SolveState::goOnFrom(const SolveCheckpoint& c) {
    progress_.takeOver(c.seconds);
    meter_.begin(Stage::resuming);
    plan_ = c.plan;
    clusters_ = c.clusters;
    suspect_ = c.suspect;
    for (const EmitterCluster& e : clusters_.emitters) {
        for (uint32_t v : e.vertices)
            if (v >= scene_.mesh.vertexCount()) throw Error("the checkpoint names a vertex that does not exist");
        for (uint32_t t : e.triangles)
            if (t >= scene_.mesh.triangles.size()) throw Error("the checkpoint names a triangle that does not exist");
    }
    indexEmitters(scene_, clusters_);
    noMetals_ = c.noMetals;
    backgroundRefuted_ = c.backgroundRefuted;
    rebuildNearField();
    environmentBlack_ = c.environmentBlack;
    refined_ = c.refined;
    refinedMisfit_ = c.refinedMisfit;
    lighting_.leaves = LightLeaves::of(c.leaves, scene_.axes);
    lighting_.leafRadiance = c.leafRadiance;
    lighting_.emitterRadiance = c.emitterRadiance;
    if (c.visibilityStep > uint32_t(options_.visibilitySide) || (c.visibilityStep & (c.visibilityStep - 1)))
        throw Error("the checkpoint's visibility has a step of {}", c.visibilityStep);
    if (c.visibilityStep) {
        meter_.begin(Stage::visibility);
        learnVisibility(int(c.visibilityStep));
    }
    rebuildRows();
    takeStrengths(c.lightSmoothness, c.albedoSmoothness);
    if (!c.matteRadiance.empty()) {
        if (c.matteRadiance.size() != matte_.vertices.size() || c.matteSigma.size() != matte_.vertices.size())
            throw Error("the checkpoint's observations are not those of the capture");
        matteSeen_ = matte_;
        matte_.radiance = c.matteRadiance;
        matte_.sigma = c.matteSigma;
    }
    bouncedFraction_ = c.bouncedFraction;
    noBounceBecause_ = c.noBounceBecause;
    if (c.bounceKept) {
        traceBounceRays(BounceOptions{}.rays);
        vertexBounce_ = c.vertexBounce;
        outgoing_ = c.outgoing;
        if (!vertexBounce_.empty()) takeVertexBounce();
    }
    gloss_ = c.gloss;
    firstGloss_ = c.firstGloss;
    for (ComponentGloss& g : gloss_)
        if (g.lobe) findMeasured(*g.lobe, basis_);
    for (ComponentGloss& g : firstGloss_)
        if (g.lobe) findMeasured(*g.lobe, basis_);
    metalsHeard_ = c.metalsHeard;
    metalsJoined_ = c.metalsJoined;
    lightUnfinished_ = c.lightUnfinished;
    for (size_t k = 0; k < 3; ++k) {
        const Eigen::Index n = Eigen::Index(c.informationSeen[k].size()),
                           m = c.informationOfObservations[k].empty() ? 0 : n;
        information_.observations[k] = Eigen::Map<const Eigen::MatrixXd>(c.informationOfObservations[k].data(), m, m);
        information_.seen[k] = Eigen::Map<const Eigen::VectorXd>(c.informationSeen[k].data(), n);
    }
    const Eigen::Index unknowns = 3 * Eigen::Index(c.informationSeen[0].size());
    information_.all.resize(unknowns, unknowns);
    const double* from = c.information.data();
    for (Eigen::Index j = 0; j < unknowns; from += unknowns - j, ++j) {
        std::copy(from, from + unknowns - j, information_.all.col(j).data() + j);
        information_.all.row(j).tail(unknowns - j) = information_.all.col(j).tail(unknowns - j).transpose();
    }
    albedo_.albedo = c.albedo;
    palette_.colours = c.palette;
    albedo_.confidence = c.confidence;
    timeline_ = c.timeline;
    stability_.kktResidual = c.kktResidual;
    computeLit();
    logInfo("going on after {:.1f} s of an earlier solve, {} entries of its timeline", c.seconds, timeline_.size());
}

SolvePlan SolveState::measuredPlan() const {
    SolvePlan plan = plan_;
    for (const StageCost& cost : meter_.stages()) {
        const bool foreseen = std::any_of(plan.stages.begin(), plan.stages.end(),
                                          [&](const PlannedStage& s) { return s.stage == cost.stage; });
        if (!foreseen && cost.seconds < 1e-3) continue;  // a step with nothing to do
        PlannedStage& stage = plan.stage(cost.stage);
        stage.measuredSeconds = std::max(0.0, stage.measuredSeconds) + cost.seconds;
        stage.measuredMib = std::max(stage.measuredMib, cost.mib);
    }
    return plan;
}

}  // namespace relamp
