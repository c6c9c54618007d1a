// The working state of one solve: what solveScene's steps share. Not a door.
#pragma once
#include "solve/albedo_free.h"
#include "solve/gloss.h"
#include "solve/solve.h"
#include "solve/uncertainty.h"
#include "transport/bounce.h"

namespace relamp {

/// What the albedo-free solve takes.
struct RatioProblem {
    InfluenceMatrix influence;
    MatteObservations observations;
    std::vector<AlbedoPair> pairs;
    std::vector<Rgb> bounce;
};

class SolveState {
public:
    SolveState(const Capture& capture, const Scene& scene, const RadianceSamples& samples, const SolveOptions& options, Progress& progress, const SolveListener* listener);

    void takeClusters(const EmitterClusters& clusters);
    void prepare();
    /// True when enough of the surface has a matte signal for the albedo-free start.
    bool hasMatte() const { return matteShare_ > 0.15; }
    bool hasGloss() const { return !gloss_.empty(); }
    bool stopped() const { return progress_.outOfTime(); }
    /// METHOD 11.
    void startFromRatios();
    /// Where nothing is matte: one constant lobe, light first; the lobe that explains the looks best is kept.
    void startFromConstantReflectance();
    /// Re-fit test: an uncertain patch that needs an albedo well above 1 (1.5) under the light found is a lamp, others are surfaces.
    /// True when the set changed.
    bool confirmEmitters();
    /// Leaves the distant light out where it gives less than half a percent of what is seen: less than the photographs can tell.
    void leaveOutBlackEnvironment();
    /// Do the photographs hold light bounced between surfaces? Fits the light with and without it and keeps what explains ratios better.
    void decideBounce();
    /// Bounced light, if it was kept, from what the photographs show of its senders; senders that no photograph shows send their albedo
    /// times their light.
    void updateBounce();
    /// Splits strong leaves; false when there is nothing left to split.
    bool refineLeaves();
    void improveLight(int iterations);
    /// One round of [Put15] 3.2: light given reflectance, reflectance given light.
    void alternate();
    /// [Haber09]'s way in: constant albedo, light first.
    void startFromConstantAlbedo();
    void solveReflectance();
    /// Gives the listener, if there is one, an estimate as things stand; the state is afterwards as it was.
    void showSnapshot();
    Estimate finish();

private:
    const Capture& capture_;
    const Scene& scene_;
    const RadianceSamples& samples_;
    const SolveOptions& options_;
    Progress& progress_;
    const SolveListener* listener_;

    EmitterClusters clusters_;
    std::vector<uint8_t> suspect_;           ///< per emitter: 1 = only a light fit can decide
    std::vector<EmitterSurface> surfaces_;
    MatteObservations matte_;
    std::vector<AlbedoPair> pairs_;
    double matteShare_ = 0;
    bool environmentBlack_ = false;
    Visibility visibility_;
    NearField nearField_;
    InfluenceMatrix influence_;              ///< of the matte observations: leaves, then emitters
    LightAnchors anchors_;
    LightPriorOptions lightPrior_;
    std::vector<float> leafShape_;           ///< per cell of the background grid: relative brightness inside its leaf
    Lighting lighting_;
    BrdfBasis basis_ = builtInBasis();
    std::vector<PieceGloss> gloss_;          ///< pieces with a lobe
    bool metalsHeard_ = false;               ///< pieces that seem to be metal were taken for metal once,
    bool metalsJoined_ = false;              ///< and had a say in the light
    AlbedoResult albedo_;
    std::vector<Rgb> lit_, litSigma_;        ///< per matte observation
    BounceRays bounceRays_;                  ///< empty: bounced light plays no part
    std::vector<Rgb> vertexBounce_, bounce_; ///< bounced light per vertex and per matte observation, empty likewise
    float bouncedShare_ = 0;
    std::string noBounceBecause_ = "nothing was matte";
    std::vector<TimelineEntry> timeline_;
    StabilityReport stability_;
    std::array<LightInformation, 3> information_;  ///< of the last albedo-free step

    /// Direct light at any vertices, as a white matte surface shows it.
    std::vector<Rgb> directAt(const std::vector<uint32_t>& vertices);
    float bouncedShareOf() const;
    void rebuildNearField();
    void uniformLight();
    void shapeLeaves();
    LobeRowOptions rowOptions() const;
    void splitLeaves(const std::vector<uint32_t>& leaves);
    AlbedoFreeReport runAlbedoFree(const std::string& stage, int iterations, const ViewRows* rows, const RatioProblem* problem = nullptr);
    /// Looks at pieces that have a matte part too, with their reflectance as it is now.
    ViewRows viewRows(Progress& progress);
    /// Looks at pieces without a matte part join the matte observations: the lobe's weight cancels between two looks at the same piece, as
    /// albedo does, so the piece says how the light is spread and has no say in its scale.
    RatioProblem ratiosWithMetals();
    /// A metal shows distant light sharper than matte surfaces do: leaves are halved to a side of 32 where neighbours differ.
    void sharpenForMetals();
    void computeLit();
    /// Albedo of every vertex under the present light; metals have none.
    void updateAlbedo();
    /// Relative difference between points of probably equal albedo under the present light (robustStep): the same measure in every stage
    /// and mode, because albedo cancels and cannot hide what the light gets wrong. Needs lit_.
    double pairMismatch() const;
    void record(const std::string& stage, int iteration, double objective, double rmse);
    /// Lighting, environment picture, emitters and reflectance as they stand, before the gauge.
    Estimate assemble() const;
    LightUncertainty uncertainty(bool scaleOnly);
    /// How sure the light, the albedo and the environment picture are.
    void assessUncertainty(const LightUncertainty& light, Estimate& estimate) const;
    void applyGauge(const LightUncertainty& light, Estimate& estimate);
    void assembleEnvironment(Estimate& estimate) const;
    void assess(Estimate& estimate);
};

}  // namespace relamp
