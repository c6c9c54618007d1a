#include "pipeline/plan_costs.h"

namespace relamp {
namespace {

constexpr double mib = 1 << 20;

/// Walks through the stages of a solve in their order; `leaves_` is how many directions are told apart by then.
class StagePrediction {
public:
    StagePrediction(const WorkCounts& counts, const MachineSpeed& speed, const PilotFindings& pilot,
                    const SolveOptions& options, const PlanChoices& choices)
        : n(counts), speed_(speed), pilot_(pilot), options_(options), choices_(choices) {
        known_ = choices.unobservedVertices ? n.vertices : n.seen;
        cells_ = double(options.visibilitySide) * options.visibilitySide;
        distant_ = choices.distantLight;
        // A solve that builds the distant light of a black environment finds that out after the coarse fit.
        fitsDistant_ = distant_ && !(pilot.ran && pilot.distantFraction < 0.005 && n.emitters > 0);
        near_ = options.nearField && n.matte;
        leavesStart_ = distant_ ? double(size_t(1) << (2 * options.startLevel)) : 1;
        leavesCoarse_ = distant_ ? std::max(16.0, leavesStart_ / 4) : 1;
        // From the pilot's light, strong directions divided.
        started_ = pilot.ran && near_ && fitsDistant_ && leavesCoarse_ < leavesStart_;
        const double pilotColumns = double(pilot.columns),
                     products = anew / 3 * productSeconds(double(pilot.rows), pilotColumns);
        pairSeconds_ =
            !pilot.ran ? 0
                       : std::max(0.0, pilot.iterationSeconds - products) / double(std::max<size_t>(1, pilot.pairs));
        albedo_ =
            n.vertices * std::log2(std::max(2.0, n.vertices)) * speed.sparse * double(options.prior.iterations) / 2;
        albedoMib_ = n.vertices * (3 * 20 * 12 * 2 + 3 * 7 * 16) / mib;
    }

    std::vector<StageEstimate> all() {
        transport();
        coarseLight();
        light();
        bouncedLight();
        finerLight();
        surfaces();
        stages_.push_back(
            {Stage::closing,
             productSeconds(n.rows, leaves_) / 9 + 10 * speed_.factorPerCube * leaves_ * leaves_ * leaves_,
             roundMib(leaves_) + 6.0});
        return std::move(stages_);
    }

private:
    static constexpr double anew = 0.65;  ///< of the rounds of a fit form their products anew

    double productSeconds(double rows, double columns) const {
        return rows * (speed_.gramPerColumn * columns + speed_.gramPerSquare * columns * columns);
    }
    /// One round of the ratio fit: products within the channels (symmetric) and between them (not), which two rounds of
    /// three form anew, one program for all three, some passes over the rows, and the pairs' own terms. The pilot takes
    /// each channel by itself: a third of the products.
    double roundSeconds(double columns) const {
        return anew * productSeconds(n.rows, columns) + 27 * speed_.factorPerCube * columns * columns * columns +
               8 * n.rows * columns * 4 * speed_.bytes + n.pairs * pairSeconds_;
    }
    static double roundMib(double columns) {
        return (36 * columns * columns * 8 + 2 * 512 * columns * 4 * 2 + 4 * columns * columns * 8) / mib;
    }

    void transport() {
        stages_.push_back({Stage::ratios, known_ * pilot_.nearSecondsPerPoint,
                           (n.pairs * 12 + n.rows * 40 + n.vertices * n.emitters * 8) / mib});
        // Rays of a lattice of 2 x 2 cells, and then all the others or those near edges.
        const double visibility =
            known_ * (choices_.agreeingRays ? cells_ / 2 * pilot_.visibilitySecondsPerRay
                                            : cells_ / 8 * pilot_.visibilitySecondsPerRay + pilot_.edgeSecondsPerPoint);
        if (distant_) stages_.push_back({Stage::visibility, visibility, n.vertices * cells_ / 8 / mib});
        stages_.push_back({Stage::rows, distant_ ? n.rows * cells_ * pilot_.rowSecondsPerCell : 0.0,
                           n.rows * (leavesCoarse_ + n.emitters) * 4 / mib});
    }

    void coarseLight() {
        const double rounds =
            started_ ? 2.5 : std::clamp(0.7 * double(pilot_.iterations), 4.0, double(options_.startIterations));
        leaves_ = leavesCoarse_ + n.emitters;
        if (!near_) return;
        // Strong directions are divided once more or twice, with an iteration or two each.
        const double strongLeaves = leaves_ + 40;
        const double strong = fitsDistant_ && leavesCoarse_ < leavesStart_
                                  ? 2.5 * roundSeconds(strongLeaves) + 0.2 * n.rows * cells_ * pilot_.rowSecondsPerCell
                                  : 0.0;
        stages_.push_back({Stage::coarseLight, rounds * roundSeconds(leaves_) + strong,
                           roundMib(strong > 0 ? strongLeaves : leaves_)});
        // A few observations a component, three eighths of the directions.
        const double first = n.glossyObservations * 120 / 700;
        if (n.glossyObservations > 0)
            stages_.push_back(
                {Stage::firstSurfaces, n.observationSeconds * 0.375 * first * 6, first * strongLeaves * 4 / mib});
    }

    void light() {
        if (!near_ || !fitsDistant_) return;
        leaves_ = leavesStart_ + n.emitters;
        stages_.push_back({Stage::light, n.rows * cells_ * pilot_.rowSecondsPerCell + 4 * roundSeconds(leaves_),
                           n.rows * leaves_ * 4 / mib + roundMib(leaves_)});
    }

    void bouncedLight() {
        using Bounce = SolveOptions::Bounce;
        if (!near_ || options_.bounce == Bounce::off || !(choices_.bounce || options_.bounce == Bounce::on)) return;
        // Clearly worse is given up after the first fit; else it goes on for some rounds.
        const bool automatic = options_.bounce == Bounce::automatic;
        const double rounds = pilot_.bounceWorse > 10 && automatic ? 9 : 22;
        const double rays = std::min(256.0, double(1 << 25) / std::max(1.0, n.vertices));
        const double trace = n.vertices * rays * pilot_.bounceSecondsPerRay, coarse = leavesCoarse_ + n.emitters;
        // Tried on coarse light and, as likely as not, ruled out there. Where it is likely, by few rays from the start.
        const double trySeconds = choices_.bounceLikely               ? 12 * roundSeconds(leaves_) + 4 * albedo_
                                  : automatic && !choices_.lateBounce ? 14 * roundSeconds(coarse) + 2 * albedo_
                                                                      : rounds * roundSeconds(leaves_) + 4 * albedo_;
        stages_.push_back({Stage::bouncedLight, trace * (choices_.bounceLikely ? 1.25 : 1.0) + trySeconds,
                           n.vertices * rays * pilot_.enclosure * 8 / mib + albedoMib_});
    }

    void finerLight() {
        if (!fitsDistant_) return;
        // Strong directions are divided already: each round divides fewer than the one before, and the third is the
        // last as a rule.
        double seconds = 0, wider = leaves_ + 25;
        const int rounds = std::min(3, options_.refineRounds);
        for (int round = 0; round < rounds && near_; ++round) {
            wider = std::min(double(options_.maxLeaves), wider + (90 >> round));
            seconds +=
                ((started_ ? 3 : 4) - round) * roundSeconds(wider) + 0.1 * n.rows * cells_ * pilot_.rowSecondsPerCell;
        }
        leaves_ = wider;
        stages_.push_back({Stage::finerLight, seconds,
                           2 * n.rows * leaves_ * 4 / mib - n.rows * leavesStart_ * 4 / mib + roundMib(leaves_)});
    }

    void surfaces() {
        const double observations = n.glossyObservations + (choices_.matteComponents ? n.matteObservations : 0.0),
                     fitSeconds = n.observationSeconds * observations;
        // Where no lobe is likely the first glance at all of them is all there is.
        const double tried = choices_.lostLobes ? n.lobes + 4 : n.lobeLikely ? 6 : 1.5;
        stages_.push_back(
            {Stage::surfaces, fitSeconds * tried + albedo_, std::max(albedoMib_, observations * leaves_ * 4 / mib)});
        if (observations > 0 && n.lobeLikely && options_.glossRounds > 0) {
            const double rounds = options_.glossRounds + (n.metals ? options_.metalRounds : 0),
                         glossy = n.glossyObservations;
            if (glossy > 0) {
                // What metals reflect is divided to a side of 32.
                if (n.metals) leaves_ = std::max(leaves_, 1024 + n.emitters);
                const double fit = fitsDistant_ ? roundSeconds(leaves_) + productSeconds(glossy, leaves_) / 3 : 0.0;
                stages_.push_back(
                    {Stage::glossLight,
                     rounds * (3 * fit + glossy * (n.observationSeconds + cells_ * pilot_.rowSecondsPerCell)),
                     glossy * leaves_ * 4 * 5 / mib + roundMib(leaves_)});
                stages_.push_back({Stage::glossSurfaces, rounds * (fitSeconds * tried + albedo_),
                                   std::max(albedoMib_, observations * leaves_ * 4 / mib)});
            }
        } else if (near_ && fitsDistant_ && n.glossyObservations > 0 && options_.glossRounds > 0) {
            // Observations that no lobe explains: the light that was to be fitted with them is fitted to its end
            // without.
            stages_.push_back(
                {Stage::glossLight, 3 * roundSeconds(leaves_) + fitSeconds * tried + albedo_, roundMib(leaves_)});
        }
        if (near_ && (n.glossyObservations == 0 || !n.lobeLikely) && fitsDistant_)
            stages_.push_back({Stage::turns,
                               double(options_.turns) * (productSeconds(n.rows, leaves_) / 3 +
                                                         6 * n.rows * leaves_ * 4 * speed_.bytes + albedo_),
                               std::max(albedoMib_, roundMib(leaves_))});
    }

    const WorkCounts& n;
    const MachineSpeed& speed_;
    const PilotFindings& pilot_;
    const SolveOptions& options_;
    const PlanChoices& choices_;
    double known_ = 0, cells_ = 0, leavesStart_ = 1, leavesCoarse_ = 1, leaves_ = 1;
    double pairSeconds_ = 0, albedo_ = 0, albedoMib_ = 0;
    bool distant_ = true, fitsDistant_ = true, near_ = true, started_ = false;
    std::vector<StageEstimate> stages_;
};

}  // namespace

std::vector<StageEstimate> predictStages(const WorkCounts& counts, const MachineSpeed& speed,
                                         const PilotFindings& pilot, const SolveOptions& options,
                                         const PlanChoices& choices) {
    return StagePrediction(counts, speed, pilot, options, choices).all();
}

}  // namespace relamp
