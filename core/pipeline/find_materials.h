// Do photographs show parts of a connected component that shine, beside parts that do not?
#pragma once
#include "capture/capture.h"
#include "clusters/emitter_clusters.h"
#include "radiance/samples.h"
#include "scene/scene.h"
#include "solve/solve.h"

namespace relamp {

/// The scene with such parts as materials of their own (Scene::material), found under the light of the planner's
/// pilot; null where there are none. Left out where none may be (mayHaveParts, which `exact` belongs to). Cost
/// otherwise: the pilot and glossyRegions, 2 to 5 s on a mesh of 60000 vertices. Throws Cancelled.
std::shared_ptr<const Scene> findMaterials(const Capture& capture, const Scene& scene, const RadianceSamples& samples,
                                           const EmitterClusters& clusters, bool exact, const SolveOptions& options,
                                           Progress& progress);

}  // namespace relamp
