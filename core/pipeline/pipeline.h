// The conductor: the paper's pipeline from capture to estimate, one room after the other.
#pragma once
#include <filesystem>
#include <memory>

#include "base/progress.h"
#include "base/stage_meter.h"
#include "capture/load_capture.h"
#include "pipeline/plan.h"
#include "pipeline/probe_stage.h"
#include "radiance/gather.h"
#include "scene/decimate.h"
#include "scene/scene.h"
#include "solve/solve.h"
#include "solve/unobserved/unobserved_light.h"

namespace relamp {

struct PipelineOptions {
    LoadOptions load;
    GatherOptions gather;
    ClusterOptions clusters;
    SolveOptions solve;
    bool everything = false;  ///< the planner leaves nothing out
    bool photometric =
        true;  ///< exposure, white balance and fall-off are taken out of the photographs where they differ clearly
    bool registration = true;  ///< cameras and mesh are brought together where photographs agree clearly better so
    bool materials = true;     ///< parts of a component that shine get lobes of their own; with near-field light only
    bool mend = true;  ///< emitters that the mesh does not show as the photographs do get their shape from these
    std::vector<LightProbe> probes = {};       ///< images of the light as it was on the set
    std::vector<MirrorBall> mirrorBalls = {};  ///< the same; they join the probes when the capture is read
    bool findLight = false;  ///< looks for an emitter that no photograph shows and puts a proxy in its place
    std::optional<size_t> meshTriangles = {};  ///< that the mesh may have in the solve (pipeline/working_mesh.h); 0: as
                                               ///< it is, none: large meshes are decimated
    bool onlyPlan = false;                     ///< stops before the solve: the estimate holds the plan alone
    bool plan = true;                          ///< false: nothing is planned, PlanChoices is what it is by default
    std::optional<int> texture = {};           ///< side of the texture at most, texels; 0: no texture, none: where
                                               ///< photographs are finer than the mesh (pipeline/texture_stage.h)
    bool reproduce = true;                     ///< false: how well the photographs are explained is not measured
    /// Asked when the capture is read, before anything is computed: where an earlier solve of it stood, or nothing.
    std::function<std::optional<SolveCheckpoint>(const Capture&)> resume = {};
};

/// Lobes by the name of a basis, with those that are fitted to the measured materials of a folder, if one is given.
/// Throws Error for another name and for materials that cannot be read.
void chooseBasis(const std::string& name, const std::filesystem::path& merl, SolveOptions& options);

/// Everything that the answer for `capture` rests on, as a number (shot/checkpoint.h).
uint64_t fingerprintOf(const Capture& capture, const PipelineOptions& options);

/// Unwraps the mirror balls, which join the probes; those in the capture's own photographs are masked there. Throws
/// Error that names a ball which is not found.
void takeMirrorBalls(PipelineOptions& options, Capture& capture);

/// Products of rooms 2 to 4 for the mesh that the solve runs on. Whoever knows the emitters may change `clusters`.
struct Prepared {
    std::optional<DecimatedMesh> working;  ///< that mesh, where the capture's is too large
    std::shared_ptr<const Scene> scene;
    std::shared_ptr<const RadianceSamples> samples;
    EmitterClusters clusters;
    float meshError = 0;  ///< metres that the mesh may be off by; 0: no photograph speaks against it
};

/// Rooms 2 to 4. `scene` and `samples`, if not null, are those of the capture's own mesh, made before; they are used
/// where the solve runs on that mesh.
Prepared prepare(const Capture& capture, const PipelineOptions& options, StageMeter& meter, Progress& progress,
                 std::shared_ptr<const Scene> scene = {}, std::shared_ptr<const RadianceSamples> samples = {});

/// What was put right because it was not good enough for a solve.
struct Corrections {
    RegistrationFix registration;  ///< of cameras and mesh
    PhotometricFix photometric;    ///< taken out of the photographs
    MeshMend mend;                 ///< of the mesh; balls of light that it lacks are among the capture's proxies
    int smoothedNormals = 0;       ///< rounds of smoothing that the normals have had
};

/// Are poses, exposures and normals good enough? Where cameras and mesh that are moved a little let the photographs
/// agree clearly better, they are moved. Where the photographs agree clearly better without what exposures, white
/// balance and lens differ by, that is taken out of `capture`; where smoother normals explain them clearly better, its
/// normals are smoothed; `prepared` follows. What options.load.fix says already is kept as it is. Of a large mesh all
/// is found on its working mesh, if that has 50000 triangles, and carried back; else its shape stays. Throws
/// Cancelled.
Corrections correctCapture(const PipelineOptions& options, Capture& capture, Prepared& prepared, StageMeter& meter,
                           Progress& progress);

/// Is there an emitter that no photograph shows? Rooms 2 to 4, and the search (solve/unobserved). `scene` and `samples`
/// as for prepare.
UnobservedLightSearch searchUnobservedLight(const Capture& capture, const PipelineOptions& options, Progress& progress,
                                            std::shared_ptr<const Scene> scene = {},
                                            std::shared_ptr<const RadianceSamples> samples = {});

/// What stands in the mesh for an emitter that was found: a sphere, small beside its distance, so that its shadows are
/// those of the point it was found as.
ProxyLight proxyOf(const UnobservedLight& light);

/// Who hears of a solve, and where it starts.
struct SolveExtras {
    const SolveListener* listener = nullptr;  ///< snapshots that it hears hold a quick measure of how well the
                                              ///< photographs are explained
    const SolveCheckpoint* resume = nullptr;
    std::function<void(const SolvePlan&)> planned = {};  ///< hears the plan, or that of `resume`
};

/// Plan, solve, and how well the estimate explains the photographs. `whole` is the capture's own scene; the estimate is
/// for its mesh.
Estimate solvePrepared(const Capture& capture, const Scene& whole, const Prepared& prepared,
                       const PipelineOptions& options, StageMeter& meter, Progress& progress,
                       const SolveExtras& extras = {});

/// Every room's product, so that the window and the reports can look at each. Where the solve ran on a decimated mesh,
/// `samples` and `clusters` are of that one, `scene` and `estimate` of the capture's.
struct PipelineResult {
    Capture capture;
    std::shared_ptr<const Scene> scene;
    std::shared_ptr<const RadianceSamples> samples;
    EmitterClusters clusters;
    Estimate estimate;
    Corrections corrections;                      ///< of `capture`
    std::optional<UnobservedLightSearch> search;  ///< when it was asked for; what it found is among capture.proxies
};

/// Throws what the rooms throw.
PipelineResult runPipeline(const std::filesystem::path& captureFolder, const PipelineOptions& options,
                           Progress& progress, const SolveListener* listener = nullptr);

}  // namespace relamp
