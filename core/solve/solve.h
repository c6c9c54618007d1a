// The door of room 6: observations and transport become an estimate of lighting and reflectance.
#pragma once
#include <array>
#include <functional>
#include <memory>
#include <optional>

#include "base/progress.h"
#include "brdf/basis.h"
#include "capture/capture.h"
#include "radiance/samples.h"
#include "solve/albedo/albedo_step.h"
#include "solve/estimate.h"
#include "solve/known_patch.h"
#include "solve/probe/light_probe.h"
#include "solve/solve_checkpoint.h"

namespace relamp {

/// What the user knows about the light/albedo scale.
struct GaugeChoice {
    enum class Kind { automatic, whitePatch, emitter, albedo } kind = Kind::automatic;
    int view = 0;
    Vec2 pixel{0};  ///< white patch: where it is seen
    float whiteAlbedo = 0.9f;
    std::string emitter;  ///< emitter id
    Rgb radiance{0};      ///< its known radiance
    float albedo = 0.5f;  ///< mean albedo of the scene
};

struct SolveOptions {
    bool nearField =
        true;            ///< false: the distant-only baseline of [Haber09], N left out, emitters are ordinary geometry
    int startLevel = 4;  ///< quadtree level of the first lighting solve: side 16
    int refineRounds = 4;  ///< splits of strong leaves, down to side 256
    size_t maxLeaves = 480;
    int visibilitySide = 64;
    int startIterations = 25, refineIterations = 6, glossRounds = 2;
    int metalRounds = 0;  ///< further rounds of lobe and light where there are metals, which see light that matte
                          ///< surfaces do not tell apart
    int turns = 1;  ///< final rounds of light and reflectance in turn
    float splitFraction =
        0.008f;  ///< a leaf that gives more than this fraction of the light at the vertices, on average, is split
    AlbedoPrior prior;  ///< the one place where priors on reflectance enter
    float lightSmoothness = 0,
          albedoSmoothness =
              0;  ///< factors on the priors' usual strength; 0: the photographs are asked (solve/prior_strength.h)
    size_t palette = 0;          ///< materials the scene is said to have, each of one albedo; 0: nothing is said
    bool askForStrength = true;  ///< false: they are not, and what is 0 is 1
    GaugeChoice gauge;
    /// Light that surfaces send each other: by the photographs, never, always.
    enum class Bounce { automatic, off, on } bounce = Bounce::automatic;
    uint64_t seed = 1;
    BrdfBasis basis = builtInBasis();  ///< lobes that surfaces may have
    size_t mostLobes = 1;              ///< that one component may mix; more than 1 with a wide basis
    FittedProbes probes;               ///< light probes of the set that take part
    size_t probedEnvironment = 0;      ///< whose probes they are, of the environments of the lighting states
    std::vector<KnownPatch> patches;   ///< surfaces whose albedo is known
    float meshError = 0;               ///< metres that the mesh may be off by; 0: it is exact
    SolvePlan plan;                    ///< what takes part: the planner's word (pipeline/plan.h)
};
/// "draft", "standard" or "fine". Throws Error for another name.
SolveOptions solveOptionsFor(const std::string& quality);

/// Hears of a solve while it runs, on the solving thread. What it hears changes nothing in the answer.
struct SolveListener {
    std::function<void(const TimelineEntry&)> entry;
    std::function<void(Estimate)> snapshot;  ///< a whole estimate as it stands, after a large step
    double snapshotFraction = 1;             ///< of the time, which snapshots may take; 1: each large step has one
    std::function<void(const SolveCheckpoint&)> checkpoint;  ///< from where the solve could go on: after each stage,
                                                             ///< and inside long ones every `checkpointSeconds`
    double checkpointSeconds = 20;
};

/// Separates distant light, emitters and reflectance. `clusters` are the candidates of room 4 (ignored when nearField
/// is off). Runs out of its time budget: the best estimate so far, marked; looked at every 100 ms or so but in the
/// coarse first fit, which is always finished, and in the closing figures. `resume`, when not null, is where an earlier
/// solve of the same inputs stood: after a finished stage the answer has the same bits as that of a solve that was
/// never stopped. Throws Error when no vertex was observed, Cancelled when stopped. Memory: columns x vertices floats
/// (4 B x 500 x 34k = 68 MiB on a 34k mesh).
Estimate solveScene(const Capture& capture, const Scene& scene, const RadianceSamples& samples,
                    const EmitterClusters& clusters, const SolveOptions& options, Progress& progress,
                    const SolveListener* listener = nullptr, const SolveCheckpoint* resume = nullptr);

}  // namespace relamp
