// A ball that explains what the photographs show of an emitter: bulbs, globes and beads that a reconstruction did not
// get, or got in part.
#pragma once
#include <optional>

#include "capture/capture.h"
#include "clusters/emitter_clusters.h"
#include "radiance/samples.h"
#include "scene/scene.h"

namespace relamp {

/// What one view shows of an emitter: its pixels, and the points between them and the others.
struct EmitterOutline {
    size_t view = 0;
    std::vector<uint8_t> shows;  ///< per pixel of the view
    size_t pixels = 0;
    Vec2 centre{0};              ///< of its pixels
    std::vector<Vec2> boundary;  ///< pixel positions, at most 400
    size_t boundaryLength = 0;   ///< sides of pixels
    bool cut = false;            ///< the photograph's frame cuts it
};

/// Outlines of the cluster in the views that show it whole: the connected pixels of its radiance that lie about the
/// projection of its vertices. Views that show it at their border (but for `cutToo`), in fewer than 8 pixels, or as one
/// with another of `clusters` are left out. O(pixels x views).
std::vector<EmitterOutline> emitterOutlines(const Scene& scene, const Capture& capture, const RadianceSamples& samples,
                                            const EmitterClusters& clusters, const EmitterCluster& cluster,
                                            bool cutToo = false);

/// Whether photographs show both, of one radiance, in one piece: in three views, and in all but a fifth of those that
/// show both, or whether all views that show one where either lies show the same piece there, in three at least: what
/// little a mesh has of a light may show no pixels. Lights that merely hide each other from some sides are apart in
/// others. O(pixels).
bool shownInOnePiece(const Scene& scene, const Capture& capture, const RadianceSamples& samples,
                     const EmitterCluster& first, const EmitterCluster& second);

struct EmitterSphere {
    DVec3 centre{0};    ///< metres
    double radius = 0;  ///< metres
    /// Pixels of the outlines and of the sphere's unoccluded disc that both have, over those that either has.
    float overlap = 0;
    float mostSeen = 0;  ///< of the sphere's discs, the fraction that shows it, in the best view
    float nextSeen = 0;  ///< in the second best view
};

/// The ball whose outline the boundaries follow best (Gauss-Newton on the angle between a boundary's ray and the ball's
/// rim; robust, because an occluder's edge is boundary, too). None with fewer than two views 10 degrees apart.
/// Parts of its disc where the mesh lies before it and no light shows count as occluded.
std::optional<EmitterSphere> fitSphere(const Scene& scene, const Capture& capture, const RadianceSamples& samples,
                                       const std::vector<EmitterOutline>& outlines);

/// Balls of one radiance whose outlines touch or hide each other in some views, as flames of candles do.
struct BallsTogether {
    std::vector<EmitterSphere> balls;                   ///< in the order they were given
    std::vector<std::vector<EmitterOutline>> outlines;  ///< of each
};

/// Fits `balls` of `light`'s radiance at once, from rough places: a pixel belongs to the ball nearest to it in the
/// ball's own radii, and boundaries lie only where no light shows beside them. O(pixels x balls).
BallsTogether fitSpheresTogether(const Scene& scene, const Capture& capture, const RadianceSamples& samples,
                                 const EmitterCluster& light, std::vector<EmitterSphere> balls);

/// Pixels that both the outlines and the cluster's triangles have, over those that either has.
float meshOverlap(const RadianceSamples& samples, const EmitterCluster& cluster,
                  const std::vector<EmitterOutline>& outlines);

}  // namespace relamp
