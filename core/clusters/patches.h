// Patches of like radiance on the mesh, and the evidence for each to be an emitter. Inner part of the clusters, not a
// door.
#pragma once
#include "clusters/emitter_clusters.h"

namespace relamp {

/// What the views agree on about a vertex.
struct VertexRadiance {
    Rgb radiance{0};
    float spread = 0;  ///< relative difference between views; -1 with one view
    float weight = 0;  ///< best observation weight; 0: unobserved
};

/// Connected vertices that may be an emitter.
struct EmitterPatch {
    std::vector<uint32_t> vertices;
    Rgb radiance{0};
    EmitterEvidence evidence;
    float commonSpread = 0;  ///< relative difference between views of the patch as a whole: an exposure that is off, a
                             ///< emitter that shines more one way
    float ownSpread = 0;     ///< what is left of viewSpread without that: a reflection that wanders over the patch
    std::string reject;
};

constexpr const char* tooFewPixelsReason = "is seen by too few pixels to tell a light from a bright speck";
constexpr const char* fadesOutReason = "fades out without an edge";
constexpr size_t smallestPatch = 4;  ///< vertices

/// What the views agree on about each vertex.
std::vector<VertexRadiance> vertexRadiance(const Scene& scene, const RadianceSamples& samples);

/// Grows patches of like radiance from the brightest vertices down.
std::vector<EmitterPatch> growPatches(const Scene& scene, const std::vector<VertexRadiance>& seen, float floor,
                                      float tolerance);

/// Patches of one radiance on one connected component are one emitter seen in parts.
void mergeLikePatches(const Scene& scene, std::vector<EmitterPatch>& patches, const std::vector<VertexRadiance>& seen);

/// `accepted`, per vertex 1 on accepted patches, but for those that touch a brighter one which fades out without an
/// edge: such a patch may be a step in the middle of an uneven emitter.
std::vector<uint8_t> withoutSteps(const Scene& scene, const std::vector<EmitterPatch>& patches,
                                  std::vector<uint8_t> accepted);

/// Parts of connected vertices above `floor`, in an order that does not know the file's; none that has a vertex in
/// `except`.
std::vector<EmitterPatch> brightPatches(const Scene& scene, const std::vector<VertexRadiance>& seen, float floor,
                                        const std::vector<uint8_t>& except);

/// Measures the patch: its radiance, and how it stands against what is around it. `patchOf` is `self` on its vertices.
void judgePatch(const Scene& scene, const RadianceSamples& samples, const std::vector<VertexRadiance>& seen,
                const std::vector<int>& patchOf, int self, float reference, EmitterPatch& patch);

/// A reflection moves with the view. What is very bright and changes as a whole, and not much, is an emitter all the
/// same.
bool changesWithView(const EmitterPatch& patch, const ClusterOptions& options);

/// Where a reconstruction ends, its rim is off by a pixel or more, and observations there mix in what lies behind: a
/// window, a bright wall. A patch needs vertices away from rims, as many as the smallest patch has; one that is most of
/// its component is a sheet of its own, and its rim is its outline.
bool onlyRim(const Scene& scene, const std::vector<uint8_t>& nearRim, const std::vector<uint32_t>& seenOfComponent,
             const EmitterPatch& patch);

/// Vertices that fall on one pixel agree because they are one measurement. What a patch is told by, that it is uniform,
/// has an edge and looks alike from two sides, needs several pixels in two views, or, where only one shows it, many.
bool tooFewPixels(const Scene& scene, const Capture& capture, const RadianceSamples& samples,
                  const EmitterPatch& patch);

}  // namespace relamp
