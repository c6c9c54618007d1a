// The light as it stands, with everything that says what it does to the observations: transport, rows, anchors, prior.
#pragma once
#include "solve/ratio/albedo_free.h"
#include "solve/state/emitter_decision.h"
#include "solve/state/observations.h"
#include "transport/visibility.h"

namespace relamp {

struct LightProblem {
    Lighting lighting;
    InfluenceMatrix influence;  ///< of the matte observations: leaves, then emitters
    LightAnchors anchors;
    LightPriorOptions prior;
    PriorStrength smoothness;
    std::vector<float> leafShape;  ///< per cell of the background grid, one environment after the other: relative
                                   ///< brightness inside its leaf
    LightInformation information;  ///< of the last albedo-free fit

    std::vector<uint8_t> known;  ///< vertices whose transport is known
    Visibility visibility;
    NearField nearField;
    NearFieldCorrection correction;  ///< known at the end

    bool environmentBlack = false;
    bool backgroundRefuted = false;  ///< what is seen of the background is not what lights the scene
    bool startsFromPlan = false;     ///< the first light is that of the plan
    bool unfinished = false;         ///< its last fit was ended early, because finer ones were to follow
    bool refined = false;            ///< no leaf is worth a split any more
    double refinedMisfit = 0;        ///< of the pairs before the last split, 0: there was none

    /// With a time budget: the last light that a fit went through.
    struct BeforeCut {
        Lighting lighting;
        InfluenceMatrix influence;
        LightInformation information;
    } beforeCut;

    /// Near-field transport of the emitters; what no photograph shows is computed when it is asked for.
    void computeNearField(const SolveInput& in, const EmitterDecision& emitters);
    /// A guess that explains the median radiance.
    void guess(const EmitterClusters& emitters, const MatteObservations& matte);
    void takeStrength(const PriorStrength& strength);

    int firstLevel(const SolveInput& in, bool hasMatte) const;
    /// Coarse light makes do with four rays a leaf: an answer stands sooner, and a black environment never needs the
    /// rest.
    int visibilityStepFor(const SolveInput& in, bool hasMatte, int level) const;
    void learnVisibility(const SolveInput& in, int step);
    /// Rays of those leaves of `leaves` that are finer than what visibility has a ray for, for the vertices that `only`
    /// marks.
    void traceFinerLeaves(const SolveInput& in, const LightLeaves& leaves, const std::vector<uint8_t>& only);
    void learnTransport(const SolveInput& in, const EmitterDecision& emitters, const std::vector<uint8_t>& vertices);
    /// Rows of direct light for the vertices, whose transport is computed if it is not known yet.
    InfluenceMatrix rowsOf(const SolveInput& in, const EmitterDecision& emitters,
                           const std::vector<uint32_t>& vertices);
    /// Rows of direct light for observations, in the lighting state of each.
    InfluenceMatrix rowsOf(const SolveInput& in, const EmitterDecision& emitters, const MatteObservations& matte);
    /// Direct light at any vertices in a lighting state, as a white matte surface shows it.
    std::vector<Rgb> directAt(const SolveInput& in, const EmitterDecision& emitters,
                              const std::vector<uint32_t>& vertices, size_t state);

    /// anchors for the present leaves, without the background where it was refuted, and the leaves' shapes.
    void anchor(const SolveInput& in, const EmitterDecision& emitters);
    /// Does the background seen, where nothing else ties the scale down, ask for surfaces that cannot be (a median
    /// albedo below .04 or above 1.3)? Then it is dropped, and the light is brought to a median albedo of .5. True when
    /// that was so: the light is to be fitted again.
    bool refuteBackground(const SolveInput& in, const EmitterDecision& emitters, const MatteObservations& matte);
    /// Splits leaves in four. Nothing changes before everything is there: the work may be given up in the middle.
    void split(const SolveInput& in, const EmitterDecision& emitters, const MatteObservations& observed,
               const std::vector<uint32_t>& chosen);

    void keepForCut(const SolveInput& in);
    /// Finer directions whose fit was cut before it told anything: the coarser ones that are known are better.
    void takeBackUnfitted(const SolveInput& in, const EmitterDecision& emitters);
};

}  // namespace relamp
