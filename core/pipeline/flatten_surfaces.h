// Floors and walls of a reconstruction have waves, which turn their normals by degrees. They are flat, unless the
// photographs object.
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "capture/capture.h"
#include "clusters/emitter_clusters.h"
#include "radiance/gather.h"
#include "solve/solve.h"

namespace relamp {

struct FlattenedSurfaces {
    RegistrationFix fix;             ///< displacements alone; empty: nothing is to be flat
    std::vector<std::string> words;  ///< of each surface that is
    /// What photographs show of the mesh with `fix`; null: not asked.
    std::shared_ptr<const RadianceSamples> samples;
};

/// Brings the mesh onto its large flat surfaces (scene/flat_surface.h). Those whose waves are below 0.01 % of the
/// diagonal are flat already; if all are, it costs nothing more. Real relief shows: a surface stays as it is where the
/// photographs of its points differ by 20 % more without it, and all do where a coarse light explains ratios of
/// radiance worse by 3 % (three and four standard errors). Cameras that were aligned with the waves agree up to 5 %
/// worse on what is truly flat, so that no less can tell. `capture`: of one lighting state. Cost: one gathering and two
/// coarse fits, 1 to 3 s. Throws Cancelled.
FlattenedSurfaces flattenSurfaces(const Capture& capture, const Scene& scene, const RadianceSamples& samples,
                                  const EmitterClusters& clusters, const GatherOptions& gather,
                                  const SolveOptions& options, Progress& progress);

}  // namespace relamp
