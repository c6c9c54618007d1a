#include "pipeline/plan_costs.h"

namespace relamp {

std::vector<StageEstimate> predictStages(const WorkCounts& n, const MachineSpeed& speed, const PilotFindings& pilot,
                                         const SolveOptions& options, const PlanChoices& choices) {
    std::vector<StageEstimate> stages;
    constexpr double mib = 1 << 20;
    const double known = choices.unobservedVertices ? n.vertices : n.seen;
    const double cells = double(options.visibilitySide) * options.visibilitySide;
    const bool distant = choices.distantLight;
    // A solve that builds the distant light of black environment finds that out after the coarse fit.
    const bool black = pilot.ran && pilot.distantFraction < 0.005 && n.emitters > 0;
    const double leavesStart = distant ? double(size_t(1) << (2 * options.startLevel)) : 1,
                 leavesCoarse = distant ? std::max(16.0, leavesStart / 4) : 1;

    // One round of the ratio fit: products within the channels (symmetric) and between them (not), which two rounds of
    // three form anew, one program for all three, some passes over the rows, and the pairs' own terms. The pilot takes
    // each channel by itself: a third of the products.
    constexpr double anew = 0.65;
    const auto productSeconds = [&](double rows, double columns) {
        return rows * (speed.gramPerColumn * columns + speed.gramPerSquare * columns * columns);
    };
    const double pilotColumns = double(pilot.columns);
    const double pairSeconds =
        !pilot.ran
            ? 0
            : std::max(0.0, pilot.iterationSeconds - anew / 3 * productSeconds(double(pilot.rows), pilotColumns)) /
                  double(std::max<size_t>(1, pilot.pairs));
    const auto roundSeconds = [&](double columns) {
        return anew * productSeconds(n.rows, columns) + 27 * speed.factorPerCube * columns * columns * columns +
               8 * n.rows * columns * 4 * speed.bytes + n.pairs * pairSeconds;
    };
    const auto roundMib = [&](double columns) {
        return (36 * columns * columns * 8 + 2 * 512 * columns * 4 * 2 + 4 * columns * columns * 8) / mib;
    };
    const double albedo =
        n.vertices * std::log2(std::max(2.0, n.vertices)) * speed.sparse * double(options.prior.iterations) / 2;
    const double albedoMib = n.vertices * (3 * 20 * 12 * 2 + 3 * 7 * 16) / mib;

    stages.push_back({Stage::ratios, known * pilot.nearSecondsPerPoint,
                      (n.pairs * 12 + n.rows * 40 + n.vertices * n.emitters * 8) / mib});
    // Rays of a lattice of 2 x 2 cells, and then all the others or those near edges.
    const double visibility =
        known * (choices.agreeingRays ? cells / 2 * pilot.visibilitySecondsPerRay
                                      : cells / 8 * pilot.visibilitySecondsPerRay + pilot.edgeSecondsPerPoint);
    if (distant) stages.push_back({Stage::visibility, visibility, n.vertices * cells / 8 / mib});
    stages.push_back({Stage::rows, distant ? n.rows * cells * pilot.rowSecondsPerCell : 0.0,
                      n.rows * (leavesCoarse + n.emitters) * 4 / mib});

    const bool near = options.nearField && n.matte;
    const bool started = pilot.ran && near && distant && !black &&
                         leavesCoarse < leavesStart;  // from the pilot's light, strong directions divided
    const double coarseRounds =
        started ? 2.5 : std::clamp(0.7 * double(pilot.iterations), 4.0, double(options.startIterations));
    double leaves = leavesCoarse + n.emitters;
    // Strong directions are divided once more or twice, with an iteration or two each.
    const double strongLeaves = leaves + 40,
                 strong = distant && !black && leavesCoarse < leavesStart
                              ? 2.5 * roundSeconds(strongLeaves) + 0.2 * n.rows * cells * pilot.rowSecondsPerCell
                              : 0.0;
    if (near)
        stages.push_back({Stage::coarseLight, coarseRounds * roundSeconds(leaves) + strong,
                          roundMib(strong > 0 ? strongLeaves : leaves)});
    // A few observations a component, three eighths of the directions.
    const double firstObservations = n.glossyObservations * 120 / 700;
    if (near && n.glossyObservations > 0)
        stages.push_back({Stage::firstSurfaces, n.observationSeconds * 0.375 * firstObservations * 6,
                          firstObservations * strongLeaves * 4 / mib});
    if (near && distant && !black) {
        leaves = leavesStart + n.emitters;
        stages.push_back({Stage::light, n.rows * cells * pilot.rowSecondsPerCell + 4 * roundSeconds(leaves),
                          n.rows * leaves * 4 / mib + roundMib(leaves)});
    }
    const bool tryBounce = near && options.bounce != SolveOptions::Bounce::off &&
                           (choices.bounce || options.bounce == SolveOptions::Bounce::on);
    if (tryBounce) {
        // Clearly worse is given up after the first fit; else it goes on for some rounds.
        const bool automatic = options.bounce == SolveOptions::Bounce::automatic;
        const double rounds = pilot.bounceWorse > 10 && automatic ? 9 : 22;
        const double rays = std::min(256.0, double(1 << 25) / std::max(1.0, n.vertices));
        const double trace = n.vertices * rays * pilot.bounceSecondsPerRay, coarse = leavesCoarse + n.emitters;
        // Tried on coarse light and, as likely as not, ruled out there.
        // Where it is likely, by few rays from the start.
        const double trySeconds = choices.bounceLikely               ? 12 * roundSeconds(leaves) + 4 * albedo
                                  : automatic && !choices.lateBounce ? 14 * roundSeconds(coarse) + 2 * albedo
                                                                     : rounds * roundSeconds(leaves) + 4 * albedo;
        stages.push_back({Stage::bouncedLight, trace * (choices.bounceLikely ? 1.25 : 1.0) + trySeconds,
                          n.vertices * rays * pilot.enclosure * 8 / mib + albedoMib});
    }
    if (distant && !black) {
        // Strong directions are divided already: each round divides fewer than the one before, and the third is the
        // last as a rule.
        double seconds = 0, wider = leaves + 25;
        const int rounds = std::min(3, options.refineRounds);
        for (int round = 0; round < rounds && near; ++round) {
            wider = std::min(double(options.maxLeaves), wider + (90 >> round));
            seconds +=
                ((started ? 3 : 4) - round) * roundSeconds(wider) + 0.1 * n.rows * cells * pilot.rowSecondsPerCell;
        }
        leaves = wider;
        stages.push_back({Stage::finerLight, seconds,
                          2 * n.rows * leaves * 4 / mib - n.rows * leavesStart * 4 / mib + roundMib(leaves)});
    }
    const double observations = n.glossyObservations + (choices.matteComponents ? n.matteObservations : 0.0),
                 fitSeconds = n.observationSeconds * observations;
    // Where no lobe is likely the first glance at all of them is all there is.
    const double tried = choices.lostLobes ? n.lobes + 4 : n.lobeLikely ? 6 : 1.5;
    stages.push_back(
        {Stage::surfaces, fitSeconds * tried + albedo, std::max(albedoMib, observations * leaves * 4 / mib)});
    if (observations > 0 && n.lobeLikely && options.glossRounds > 0) {
        const double rounds = options.glossRounds;
        if (n.glossyObservations > 0) {
            const double glossy = n.glossyObservations;
            if (n.metals) leaves = std::max(leaves, 1024 + n.emitters);  // what they reflect is divided to a side of 32
            stages.push_back(
                {Stage::glossLight,
                 rounds * (3 * (distant && !black ? roundSeconds(leaves) + productSeconds(glossy, leaves) / 3 : 0.0) +
                           glossy * (n.observationSeconds + cells * pilot.rowSecondsPerCell)),
                 glossy * leaves * 4 * 5 / mib + roundMib(leaves)});
            stages.push_back({Stage::glossSurfaces, rounds * (fitSeconds * tried + albedo),
                              std::max(albedoMib, observations * leaves * 4 / mib)});
        }
    }
    // Looks that no lobe explains: the light that was to be fitted with them is fitted to its end without.
    else if (near && distant && !black && n.glossyObservations > 0 && options.glossRounds > 0)
        stages.push_back({Stage::glossLight, 3 * roundSeconds(leaves) + fitSeconds * tried + albedo, roundMib(leaves)});
    if (near && (n.glossyObservations == 0 || !n.lobeLikely) && distant && !black)
        stages.push_back({Stage::turns,
                          double(options.turns) *
                              (productSeconds(n.rows, leaves) / 3 + 6 * n.rows * leaves * 4 * speed.bytes + albedo),
                          std::max(albedoMib, roundMib(leaves))});
    stages.push_back({Stage::closing,
                      productSeconds(n.rows, leaves) / 9 + 10 * speed.factorPerCube * leaves * leaves * leaves,
                      roundMib(leaves) + 6.0});
    return stages;
}

}  // namespace relamp
