// What a solve leaves out because the scene does not need it, and what its stages cost: decided before the solve,
// measured while it runs.
#pragma once
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/stage.h"
#include "solve/omission.h"
#include "solve/unobserved/suspected_light.h"

namespace relamp {

struct RatioObservations;
struct Lighting;

/// Directions that give much of the light are divided first.
struct StrongDirections {
    static constexpr float fraction = 0.04f;  ///< of the light on the surfaces, above which one is divided
    static constexpr int rounds = 3, finest = 6;
    static constexpr int roundsByPeaks = 4;  ///< of a mesh that is off, whose misfit says little
};

/// What takes part. The default is what every solve may take for granted; the planner (pipeline/plan.h) switches off
/// more.
struct PlanChoices {
    bool distantLight = true;   ///< false: the environment is black, D is never built
    bool bounce = true;         ///< false: light between surfaces is not tried (SolveOptions::Bounce::automatic only)
    bool lateBounce = false;    ///< true: it is tried at the start level at once, not on coarse light first
    bool bounceLikely = false;  ///< true: all speaks for it, so that it joins coarse light at once
    bool unobservedVertices = false;  ///< true: transport of vertices that no photograph shows, too
    bool emptyColumns =
        false;  ///< true: directions that light no observed vertex take part in the equations' products, too
    bool matteComponents = false;  ///< true: lobes are sought on components that do not change with the view, too
    bool lostLobes = false;  ///< true: every lobe is tried on directions of its own, not only those that come near the
                             ///< best on shared ones
    bool agreeingRays = false;  ///< true: visibility is traced where coarser rays all around agree, too
    bool flatLevels = false;    ///< true: leaves are split on after a round that explained hardly more
    bool lastDigits = false;    ///< true: a fit goes on after an iteration that lowered its objective by less than 3e-4
    bool mattePointsInDetail = false;  ///< true: in the equations' products matte points tell leaves apart that were
                                       ///< split for what metals reflect
    /// Nothing is left out.
    static PlanChoices everything() {
        return {true, true, true, false, true, true, true, true, true, true, true, true};
    }
};

/// A stage of the solve; a number below 0 is not known.
struct PlannedStage {
    Stage stage = Stage::other;
    double predictedSeconds = -1, measuredSeconds = -1;
    double predictedMib = -1, measuredMib = -1;
    PlannedStage() = default;
    PlannedStage(Stage which, double predictedS, double measuredS, double predictedM, double measuredM)
        : stage(which),
          predictedSeconds(predictedS),
          measuredSeconds(measuredS),
          predictedMib(predictedM),
          measuredMib(measuredM) {}
    /// As a file names it.
    PlannedStage(const std::string& fileName, double predictedS, double measuredS, double predictedM, double measuredM)
        : PlannedStage(stageNamed(fileName), predictedS, measuredS, predictedM, measuredM) {}
};

struct PlannedOmission {
    Omission what = Omission::other;
    std::string reason;
    double savedSeconds = 0, savedMib = 0;  ///< predicted
    PlannedOmission() = default;
    PlannedOmission(Omission part, std::string because, double seconds, double mib);
    /// As a file names it.
    PlannedOmission(const std::string& name, std::string because, double seconds, double mib);
};

struct SolvePlan {
    PlanChoices choices;
    std::vector<PlannedStage> stages;
    std::vector<PlannedOmission> leftOut;
    double planningSeconds = 0;
    std::optional<SuspectedLight> suspectedLight;
    std::shared_ptr<const RatioObservations>
        observed;  ///< what planning computed and the solve takes over; null: nothing
    std::shared_ptr<const Lighting>
        light;  ///< the light planning found, strong directions finer: where the solve starts; null: nowhere
    /// That stage, made if it is not there.
    PlannedStage& stage(Stage which);
    double predictedSeconds() const;  ///< over the stages with a prediction
    double savedSeconds() const;
};

}  // namespace relamp
