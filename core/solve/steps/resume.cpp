// How a solve is put aside and gone on with.
#include "base/log.h"
#include "solve/steps/steps.h"

namespace relamp {
namespace {

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

SolveCheckpoint checkpointOf(const SolveRun& s, uint32_t step, bool between) {
    SolveCheckpoint c;
    c.step = step;
    c.between = between;
    c.seconds = s.in.progress.seconds();
    c.clusters = s.emitters.clusters;
    c.suspect = s.emitters.suspect;
    for (size_t i = 0; i < s.light.lighting.leaves.size(); ++i) c.leaves.push_back(s.light.lighting.leaves[i]);
    c.leafRadiance = s.light.lighting.leafRadiance;
    c.emitterRadiance = s.light.lighting.emitterRadiance;
    c.environmentBlack = s.light.environmentBlack;
    c.refined = s.light.refined;
    c.visibilityStep = s.light.visibility.bits.empty() ? 0 : uint32_t(s.light.visibility.step);
    c.refinedMisfit = s.light.refinedMisfit;
    c.bounceKept = s.bounce.traced();
    c.bouncedFraction = s.bounce.fraction;
    c.noBounceBecause = s.bounce.absentBecause;
    c.noMetals = s.gloss.noMetals;
    c.backgroundRefuted = s.light.backgroundRefuted;
    c.vertexBounce = s.bounce.atVertex;
    c.outgoing = s.bounce.outgoing;
    c.lightSmoothness = s.light.smoothness;
    c.albedoSmoothness = s.surfaces.smoothness;
    if (!s.observed.withCoatings.vertices.empty()) {
        c.matteRadiance = s.observed.matte.radiance;
        c.matteSigma = s.observed.matte.sigma;
    }
    c.gloss = s.gloss.components;
    c.firstGloss = s.gloss.early;
    c.metalsHeard = s.gloss.heard;
    c.metalsJoined = s.gloss.joined;
    c.glossSettled = s.gloss.settled;
    c.lightUnfinished = s.light.unfinished;
    for (Eigen::Index j = 0; j < s.light.information.all.cols(); ++j)
        c.information.insert(c.information.end(), s.light.information.all.col(j).data() + j,
                             s.light.information.all.col(j).data() + s.light.information.all.rows());
    for (size_t k = 0; k < 3; ++k) {
        const Eigen::MatrixXd& observations = s.light.information.observations[k];
        const Eigen::VectorXd& seen = s.light.information.seen[k];
        c.informationOfObservations[k].assign(observations.data(), observations.data() + observations.size());
        c.informationSeen[k].assign(seen.data(), seen.data() + seen.size());
    }
    c.albedo = s.surfaces.albedo.albedo;
    c.palette = s.surfaces.palette.colours;
    c.confidence = s.surfaces.albedo.confidence;
    c.timeline = s.timeline;
    c.kktResidual = s.stability.kktResidual;
    c.plan = s.measuredPlan();
    c.patchUsed = s.patchUsed;
    return c;
}

void resumeSolve(SolveRun& s, const SolveCheckpoint& c) {
    s.in.progress.takeOver(c.seconds);
    s.meter.begin(Stage::resuming);
    s.plan = c.plan;
    for (const EmitterCluster& e : c.clusters.emitters)
        if (e.inState.size() != (s.in.samples.states > 1 ? s.in.samples.states : 0))
            throw Error("the checkpoint holds {} levels of an emitter in {} lighting states", e.inState.size(),
                        s.in.samples.states);
    s.emitters = EmitterDecision::of(s.in.scene, c.clusters, c.suspect);
    s.gloss.noMetals = c.noMetals;
    s.light.backgroundRefuted = c.backgroundRefuted;
    s.light.computeNearField(s.in, s.emitters);
    observeAnew(s);
    s.light.environmentBlack = c.environmentBlack;
    s.light.refined = c.refined;
    s.light.refinedMisfit = c.refinedMisfit;
    s.light.lighting.leaves = LightLeaves::of(c.leaves, s.in.scene.axes, s.in.samples.environmentOfState);
    s.light.lighting.leafRadiance = c.leafRadiance;
    s.light.lighting.emitterRadiance = c.emitterRadiance;
    if (c.visibilityStep > uint32_t(s.in.options.visibilitySide) || (c.visibilityStep & (c.visibilityStep - 1)))
        throw Error("the checkpoint's visibility has a step of {}", c.visibilityStep);
    if (c.visibilityStep) {
        s.meter.begin(Stage::visibility);
        s.light.learnVisibility(s.in, int(c.visibilityStep));
    }
    rebuildRows(s);
    s.light.takeStrength(c.lightSmoothness);
    s.surfaces.take(c.albedoSmoothness, s.in.options.prior);
    if (!c.matteRadiance.empty()) {
        if (c.matteRadiance.size() != s.observed.matte.vertices.size() ||
            c.matteSigma.size() != s.observed.matte.vertices.size())
            throw Error("the checkpoint's observations are not those of the capture");
        s.observed.withCoatings = s.observed.matte;
        s.observed.matte.radiance = c.matteRadiance;
        s.observed.matte.sigma = c.matteSigma;
    }
    s.bounce.fraction = c.bouncedFraction;
    s.bounce.absentBecause = c.noBounceBecause;
    if (c.bounceKept) {
        s.bounce.trace(s.in, BounceOptions{}.rays);
        s.bounce.atVertex = c.vertexBounce;
        s.bounce.outgoing = c.outgoing;
        if (!s.bounce.atVertex.empty()) s.bounce.takeAtObservations(s.observed.matte);
    }
    s.gloss.components = c.gloss;
    s.gloss.early = c.firstGloss;
    for (ComponentGloss& g : s.gloss.components)
        if (g.lobe) findMeasured(*g.lobe, s.in.options.basis);
    for (ComponentGloss& g : s.gloss.early)
        if (g.lobe) findMeasured(*g.lobe, s.in.options.basis);
    s.gloss.heard = c.metalsHeard;
    s.gloss.joined = c.metalsJoined;
    s.gloss.settled = c.glossSettled;
    s.light.unfinished = c.lightUnfinished;
    for (size_t k = 0; k < 3; ++k) {
        const Eigen::Index n = Eigen::Index(c.informationSeen[k].size()),
                           m = c.informationOfObservations[k].empty() ? 0 : n;
        s.light.information.observations[k] =
            Eigen::Map<const Eigen::MatrixXd>(c.informationOfObservations[k].data(), m, m);
        s.light.information.seen[k] = Eigen::Map<const Eigen::VectorXd>(c.informationSeen[k].data(), n);
    }
    const Eigen::Index unknowns = 3 * Eigen::Index(c.informationSeen[0].size());
    s.light.information.all.resize(unknowns, unknowns);
    const double* from = c.information.data();
    for (Eigen::Index j = 0; j < unknowns; from += unknowns - j, ++j) {
        std::copy(from, from + unknowns - j, s.light.information.all.col(j).data() + j);
        s.light.information.all.row(j).tail(unknowns - j) =
            s.light.information.all.col(j).tail(unknowns - j).transpose();
    }
    s.surfaces.albedo.albedo = c.albedo;
    s.surfaces.palette.colours = c.palette;
    if (!c.patchUsed.empty() && c.patchUsed.size() != s.in.options.patches.size())
        throw Error("the checkpoint tells of {} patches of known albedo, expected {}", c.patchUsed.size(),
                    s.in.options.patches.size());
    s.patchUsed = c.patchUsed;
    s.surfaces.albedo.confidence = c.confidence;
    s.timeline = c.timeline;
    s.stability.kktResidual = c.kktResidual;
    logInfo("going on after {:.1f} s of an earlier solve, {} entries of its timeline", c.seconds, s.timeline.size());
}

}  // namespace relamp
