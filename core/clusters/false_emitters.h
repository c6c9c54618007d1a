// Emitters on meshes that are not exact: one emitter in several patches, and patches that shine only because an
// emitter's light or image falls where the mesh is off.
#pragma once
#include "capture/capture.h"
#include "clusters/emitter_clusters.h"
#include "clusters/patches.h"
#include "radiance/samples.h"
#include "scene/scene.h"

namespace relamp {

/// Patches of one radiance (within 3 %) a hair apart (0.6 % of the scene's diagonal) become one, the stronger one's.
/// Cost: O(n m) in the vertices of the two that lie near the other's box.
void joinSplitEmitters(const Scene& scene, std::vector<EmitterCluster>& emitters);

/// Candidates a hair from an emitter that are of its hue, 0.4 to 1 times as bright and at most a tenth as large become
/// part of it: pixels at its rim show it half. Cost as above.
void joinBlurredParts(const Scene& scene, std::vector<EmitterCluster>& emitters,
                      std::vector<EmitterCluster>& candidates);

/// Whether `patch` shows nothing but `emitter` past the mesh's edge: of the same radiance, elsewhere in space, and in
/// every photograph within 8 pixels of the emitter.
bool showsEmitterPastEdge(const Scene& scene, const Capture& capture, const RadianceSamples& samples,
                          const EmitterCluster& emitter, const EmitterCluster& patch);

/// Albedo that `patch` would need to send what it sends by reflecting the stronger ones of `emitters`, nothing standing
/// between and its normals off by up to 20 degrees: below 0.9 it is no emitter, whatever a mesh that is off says of
/// shadows. Median over the patch's vertices, largest of the channels. O(64 x their triangles).
float albedoBesideEmitters(const Scene& scene, const std::vector<EmitterCluster>& emitters,
                           const EmitterCluster& patch);

/// Whether the part could be what these emitters, of known radiance, light: its median vertex would need an albedo
/// below 1.5 if nothing stood between. O(64 x their triangles).
bool litByEmitters(const Scene& scene, const std::vector<VertexRadiance>& seen,
                   const std::vector<EmitterCluster>& emitters, const EmitterPatch& part);

}  // namespace relamp
