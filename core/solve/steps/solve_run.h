// One solve under way: the values that its steps change, and the log of what they did. Not a door.
#pragma once
#include "base/stage_meter.h"
#include "clusters/state_emitters.h"
#include "solve/albedo/near_field_correction.h"
#include "solve/state/bounce_model.h"
#include "solve/state/gloss_model.h"
#include "solve/state/irradiance.h"
#include "solve/state/light_problem.h"
#include "solve/state/surface_state.h"

namespace relamp {

/// A solve is a list of steps; between two of them it can be put aside and gone on with.
enum class SolveStep {
    firstLight,     ///< coarse light, which emitters are emitters
    strongLight,    ///< where it is strong, finer at once
    firstSurfaces,  ///< lobes by a few observations
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

struct SolveRun {
    SolveRun(const Capture& capture, const Scene& scene, const RadianceSamples& samples, const SolveOptions& options,
             Progress& progress, const SolveListener* listener);
    SolveRun(const SolveRun&) = delete;

    SolvePlan plan;
    const SolveInput in;
    const SolveListener* const listener;
    StageMeter meter;
    std::vector<TimelineEntry> timeline;
    StabilityReport stability;
    uint32_t step = 0;          ///< that runs
    bool stepMayBeCut = false;  ///< it can start again from a better light
    double lastCheckpoint = 0;
    double snapshotEnded = 0, snapshotSeconds = 0;  ///< of the last one

    EmitterDecision emitters;
    SolveObservations observed;
    LightProblem light;
    BounceModel bounce;
    GlossModel gloss;
    SurfaceState surfaces;
    std::vector<uint8_t> patchUsed;  ///< per patch of known albedo, whether it takes part; empty: not asked yet
    std::array<Eigen::MatrixXd, 3> patchPart;  ///< of the light's information, known at the end (references.cpp)

    bool stopped() const { return in.stopped(); }
    bool hasMatte() const { return observed.hasMatte(); }
    InfluenceMatrix rowsOf(const std::vector<uint32_t>& vertices) { return light.rowsOf(in, emitters, vertices); }
    /// What the present light makes of the observations.
    Irradiance irradiance() const {
        Irradiance found = irradianceOf(light.influence, light.lighting, bounce.atObservation, observed.pairs);
        addCorrection(light.correction, observed.matte, light.lighting.emitterRadiance, emitters.levels, found);
        return found;
    }
    /// The lighting state for what one state tells alone: the one in which emitters are brightest.
    uint32_t mainState() const { return brightestState(emitters.clusters, in.samples); }
    /// How many leaves the light may have: each environment as many as one alone.
    size_t mostLeaves() const {
        const size_t more = hasMatte() ? 0 : 3 * (size_t(1) << (2 * in.options.startLevel));
        return in.samples.environments() * (in.options.maxLeaves + more);
    }
    double mismatch(const Irradiance& irradiance) const {
        return pairMismatch(observed.matte, observed.pairs, irradiance);
    }
    /// Leaves of one level, of the environments of all lighting states.
    LightLeaves leavesAt(int level) const {
        return LightLeaves::uniform(level, in.scene.axes, in.samples.environmentOfState);
    }
    /// How lobes' rows are computed under the present light.
    LobeRowOptions rowOptions() const;
    void splitLeaves(const std::vector<uint32_t>& chosen) { light.split(in, emitters, observed.matte, chosen); }
    /// One line of the timeline; a checkpoint where one is due.
    void record(const std::string& stage, int iteration, double objective, double rmse);
    /// The plan with what the stages cost so far.
    SolvePlan measuredPlan() const;
};

}  // namespace relamp
