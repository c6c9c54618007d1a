// The working state of one solve: what solveScene's steps share. Not a door.
#pragma once
#include "base/stage_meter.h"
#include "solve/gloss/gloss.h"
#include "solve/ratio/albedo_free.h"
#include "solve/solve.h"
#include "solve/uncertainty.h"
#include "transport/bounce.h"

namespace relamp {

/// A solve is a list of steps; between two of them it can be put aside and gone on with.
enum class SolveStep {
    firstLight,     ///< coarse light, which emitters are emitters
    strongLight,    ///< where it is strong, finer at once
    firstSurfaces,  ///< lobes by a few looks
    startLight,     ///< light at the start level
    bounces,        ///< is there light between surfaces?
    lightStrength,  ///< how smooth is the light?
    splitStrong,    ///< leaves that give much light are split
    refineLight,
    surfaces,    ///< lobes and albedo
    glossLight,  ///< light with the lobes known
    glossSurfaces,
    turn  ///< light and albedo in turn
};
std::vector<SolveStep> stepsOf(const SolveOptions& options);
/// How far a fit of the light goes: light that strong directions are told from, light that finer fits or a choice
/// follow, light that stays.
enum class FitEnd { coarse, usual, last };

/// What the albedo-free solve takes beside the rows.
struct RatioProblem {
    MatteObservations observations;
    std::vector<AlbedoPair> pairs;
    std::vector<Rgb> bounce;
    std::vector<uint32_t> fold;  ///< AlbedoFreeOptions::fold of the rows without metals
    size_t foldedRows = 0;
};

class SolveState {
public:
    SolveState(const Capture& capture, const Scene& scene, const RadianceSamples& samples, const SolveOptions& options,
               Progress& progress, const SolveListener* listener);

    /// Observations, pairs, transport and a first guess of the light.
    void prepare(const EmitterClusters& clusters);
    /// The same for a solve that stood at `checkpoint`.
    void goOnFrom(const SolveCheckpoint& checkpoint);
    /// One step, or as much of it as the time budget leaves. `index`: its place in the list.
    void run(SolveStep step, uint32_t index);
    /// Tells the listener how things stand.
    void finishedStep(uint32_t next, SolveStep finished);
    Estimate finish();

private:
    void takeClusters(const EmitterClusters& clusters);
    /// True when enough of the surface has a matte signal for the albedo-free start.
    bool hasMatte() const { return matteFraction_ > 0.15; }
    bool hasGloss() const { return !gloss_.empty(); }
    bool stopped() const { return progress_.outOfTime(); }
    /// docs/method.md 11, on leaves of half the start level's side, and then at the start level.
    void firstLight();
    void startLight();
    /// Leaves that give much of the light are split down to a side of 64 before the others are: a sun or a window is in
    /// its place early, and all that follows starts from there.
    void sharpenStrong();
    /// Lobes of the components that change with the view, by a few looks: shown, and kept until `surfaces` finds better
    /// ones. Without them a metal is black. They have no say in the light: coarse light with metals in it claims to
    /// know the scale to a tenth where it is off by half.
    void firstSurfaces();
    /// Where nothing is matte: one constant lobe, light first; the lobe that explains the looks best is kept.
    /// False, and nothing is changed but noMetals_, where no lobe explains them better than a surface that looks alike
    /// from everywhere.
    bool startFromConstantReflectance();
    /// Re-fit test: an uncertain patch that needs an albedo well above 1 (1.5) under the light found is an emitter,
    /// others are surfaces. True when the set changed.
    bool confirmEmitters();
    /// Leaves the distant light out where it gives less than half a percent of what is seen (3 % where the background
    /// is seen and black): less than the photographs can tell.
    void leaveOutBlackEnvironment();
    /// Do the photographs hold light bounced between surfaces? Fits the light with and without it and keeps what
    /// explains ratios better. `coarse`: a first, cheap try that can only leave it out.
    void decideBounce(bool coarse);
    /// Where the plan finds bounced light likely: what the photographs show of its senders joins the light from the
    /// start, by few rays; finer light judges it (decideBounce).
    void joinLikelyBounce();
    /// Bounced light, if it was kept, from what the photographs show of its senders; senders that no photograph shows
    /// send their albedo times their light.
    void updateBounce();
    /// Splits strong leaves; false when there is nothing left to split.
    bool refineLeaves();
    void improveLight(int iterations);
    /// Fits the light to the end, where its last fit was ended early.
    void finishLight();
    /// One round of [Put15] 3.2: light given reflectance, reflectance given light.
    void alternate();
    /// [Haber09]'s way in: constant albedo, light first.
    void startFromConstantAlbedo();
    void solveReflectance();
    void askLightStrength();
    void askAlbedoStrength();
    /// Takes what coatings mirror off the matte observations. `hurry`: with a third of the directions, though the time
    /// is used up. `matteAfterAll`: per component 1 where no lobe explains its change with the view.
    void removeCoatings(bool hurry, const std::vector<uint8_t>& matteAfterAll);
    /// What changes with the view and not as a lobe does differs by geometry or exposure: the median of the views tells
    /// it, not their darker quarter.
    void readAsMatte(const std::vector<uint8_t>& components);
    /// Gives the listener, if there is one, an estimate as things stand; the state is afterwards as it was.
    void showSnapshot();
    SolveCheckpoint checkpoint(uint32_t step, bool between) const;
    /// The plan with what the stages cost so far.
    SolvePlan measuredPlan() const;
    /// `rays`: from each vertex.
    void traceBounceRays(uint32_t rays);
    /// Bounced light at the observations, from that at the vertices.
    void takeVertexBounce();
    void forgetBounce(std::string why);

    const Capture& capture_;
    const Scene& scene_;
    const RadianceSamples& samples_;
    const SolveOptions& options_;
    Progress& progress_;
    const SolveListener* listener_;
    StageMeter meter_;
    uint32_t step_ = 0;          ///< that runs
    bool stepMayBeCut_ = false;  ///< it can start again from a better light
    double lastCheckpoint_ = 0;
    SolvePlan plan_;

    EmitterClusters clusters_;
    std::vector<uint8_t> suspect_;  ///< per emitter: 1 = only a light fit can decide
    std::vector<EmitterSurface> surfaces_;
    MatteObservations matte_;
    MatteObservations
        matteSeen_;  ///< the same as seen, where what coatings mirror has been taken off; empty: nothing was
    std::vector<AlbedoPair> pairs_;
    double matteFraction_ = 0;
    bool noMetals_ = false;  ///< components that change with the view as metals do were not explained by being metals
    bool environmentBlack_ = false;
    bool backgroundRefuted_ = false;  ///< what is seen of the background is not what lights the scene
    bool startsFromPlan_ = false;     ///< the first light is that of the plan
    bool refined_ = false;            ///< no leaf is worth a split any more
    double refinedMisfit_ = 0;        ///< of the pairs before the last split, 0: there was none
    std::vector<uint8_t> known_;      ///< vertices whose transport is known
    Visibility visibility_;
    NearField nearField_;
    InfluenceMatrix influence_;  ///< of the matte observations: leaves, then emitters
    LightAnchors anchors_;
    LightPriorOptions lightPrior_;
    AlbedoPrior albedoPrior_;
    Palette palette_;  ///< empty without one
    PriorStrength lightSmoothness_, albedoSmoothness_;
    void takeStrengths(const PriorStrength& light, const PriorStrength& albedo);
    std::vector<float> leafShape_;  ///< per cell of the background grid: relative brightness inside its leaf
    Lighting lighting_;
    const BrdfBasis& basis_ = options_.basis;
    std::vector<ComponentGloss> gloss_;       ///< components with a lobe
    std::vector<ComponentGloss> firstGloss_;  ///< the same by a few looks, until gloss_ has them
    bool metalsHeard_ = false;                ///< components that seem to be metal were taken for metal once,
    bool lightUnfinished_ = false;            ///< its last fit was ended early, because finer ones were to follow
    bool metalsJoined_ = false;               ///< and had a say in the light
    AlbedoResult albedo_;
    struct BeforeSplit {
        Lighting lighting;
        InfluenceMatrix influence;
        LightInformation information;
    };
    BeforeSplit untold_;  ///< with a time budget: the last light that a fit went through
    /// Keeps the light as it is for takeBackUntold().
    void keepForCut();
    /// Finer directions whose fit was cut before it told anything: the coarser ones that are known are better.
    void takeBackUntold();
    std::vector<Rgb> lit_, litSigma_;         ///< per matte observation
    BounceRays bounceRays_;                   ///< empty: bounced light plays no part
    std::vector<Rgb> outgoing_;               ///< radiance that surfaces send each other, per vertex; empty likewise
    std::vector<Rgb> vertexBounce_, bounce_;  ///< bounced light per vertex and per matte observation, empty likewise
    float bouncedFraction_ = 0;
    std::string noBounceBecause_ = "nothing was matte";
    std::vector<TimelineEntry> timeline_;
    StabilityReport stability_;
    LightInformation information_;  ///< of the last albedo-free step

    /// Direct light at any vertices, as a white matte surface shows it.
    std::vector<Rgb> directAt(const std::vector<uint32_t>& vertices);
    float bouncedFractionOf() const;
    void rebuildNearField();
    /// Rows of direct light for the vertices, whose transport is computed if it is not known yet.
    InfluenceMatrix rowsOf(const std::vector<uint32_t>& vertices);
    void learnTransport(const std::vector<uint8_t>& vertices);
    /// Everything that follows from emitters and leaves: anchors, rows of the observations.
    void rebuildRows();
    /// anchors_ for the present leaves; without the background where it was refuted.
    void anchorLight();
    /// Does the background seen, where nothing else ties the scale down, ask for surfaces that cannot be (a median
    /// albedo below .04 or above 1.3)? Then it is dropped, and the light is brought to a median albedo of .5. True when
    /// that was so: the light is to be fitted again.
    bool refuteBackground();
    int firstLevel() const;
    /// Coarse light makes do with four rays a leaf: an answer stands sooner, and black environment never need the
    /// rest.
    int visibilityStepFor(int level) const;
    void learnVisibility(int step);
    /// Rays of those leaves of `leaves` that are finer than what visibility_ has a ray for, for the vertices that
    /// `only` marks.
    void traceFinerLeaves(const LightLeaves& leaves, const std::vector<uint8_t>& only);
    /// The rays that coarse light did without, and the rows again.
    void finishVisibility();
    void guessLight();
    void shapeLeaves();
    LobeRowOptions rowOptions() const;
    void splitLeaves(const std::vector<uint32_t>& leaves);
    AlbedoFreeReport runAlbedoFree(const std::string& stage, int iterations, const ViewRows* rows,
                                   const RatioProblem* problem = nullptr, std::optional<ChromaFraction> chroma = {},
                                   FitEnd end = FitEnd::usual);
    /// What each leaf gives of the light at a vertex, on average over the vertices. Needs lit_.
    std::vector<Rgb> lightContributions() const;
    /// Leaves that only metals tell apart: brothers that were split for them, and that give matte surfaces too little
    /// light for their split to matter. Per column of influence_ its group; empty: none.
    std::vector<uint32_t> leavesAsMatteTellsThem() const;
    /// Looks at components that have a matte part too, with their reflectance as it is now.
    ViewRows viewRows(Progress& progress);
    /// Looks at components without a matte part join the matte observations: the lobe's weight cancels between two
    /// looks at the same component, as albedo does, so the component says how the light is spread and has no say in its
    /// scale. Their rows are put behind those of influence_, where they are not held twice: whoever asks takes them
    /// back. None: no pairs.
    RatioProblem ratiosWithMetals();
    /// A metal shows distant light sharper than matte surfaces do: leaves are halved to a side of 32 where neighbours
    /// differ.
    void sharpenForMetals();
    void computeLit();
    /// Albedo of every vertex under the present light; metals have none.
    void updateAlbedo();
    void withoutMetals(std::vector<Rgb>& albedo) const;
    /// Relative difference between points of probably equal albedo under the present light (robustStep): the same
    /// measure in every stage and mode, because albedo cancels and cannot hide what the light gets wrong. Needs lit_.
    double pairMismatch() const;
    void record(const std::string& stage, int iteration, double objective, double rmse);
    /// Two views are held out in turn: albedo of all vertices without them, under the light that all views gave.
    std::vector<HeldOutAlbedo> holdOutViews();
    /// Lighting, environment image, emitters and reflectance as they stand, before the gauge.
    Estimate assemble() const;
    LightUncertainty uncertainty(bool scaleOnly);
    /// How sure the light, the albedo and the environment image are.
    void assessUncertainty(const LightUncertainty& light, Estimate& estimate) const;
    void applyGauge(const LightUncertainty& light, Estimate& estimate);
    /// Fraction of the light on the surfaces that comes from background seen directly. `backdrop`: what is seen is
    /// black or masked.
    struct SeenLight {
        double fraction = 0;
        bool backdrop = false;
    };
    SeenLight seenLight() const;
    /// What light is to be multiplied with: by the artist's word, and by what is usual where nothing tells.
    Rgb toldGauge(GaugeReport& gauge) const;
    Rgb assumedGauge(const SeenLight& seen, GaugeReport& gauge) const;
    /// Fraction of the surfaces that need an albedo above 1 when light is multiplied by `scale`; `upper`: the 95th
    /// percentile of what they need.
    float fractionAboveOne(const Rgb& scale, float& upper) const;
    /// Cuts albedo at 1; where the photographs would be explained clearly worse, higher, at 2 at most.
    void boundAlbedo(const Rgb& scale, Estimate& estimate) const;
    void assembleEnvironment(Estimate& estimate) const;
    /// From the square along the scene's axes to the world's.
    void turnEnvironment(Estimate& estimate) const;
    void assess(Estimate& estimate);
};

}  // namespace relamp
