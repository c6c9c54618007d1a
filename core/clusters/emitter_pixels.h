// Emitters as the photographs' pixels show them, where the mesh's vertices tell too little of their outline.
#pragma once
#include "capture/capture.h"
#include "clusters/emitter_clusters.h"
#include "radiance/samples.h"
#include "scene/scene.h"

namespace relamp {

/// Per pixel 1 where the view shows radiance `emitter` within `tolerance` (relative), or an edge of it that covers half
/// of the pixel. O(pixels).
std::vector<uint8_t> emittingPixels(const View& view, const Rgb& emitter, float tolerance);

/// Relative tolerance within which pixels show the cluster's own radiance.
float pixelTolerance(const EmitterCluster& cluster);

/// Adds to `cluster` the connected triangles whose pixels show its radiance, as most of the views that see them say.
/// The vertices beside a crease or an edge of the mesh hold no clean observation; on a reconstructed mesh these are
/// many, and the emitter would come out too small and its light too strong for its size. Triangles of `taken` vertices
/// stay out. Returns how many triangles were added. O(pixels).
size_t growByPixels(const Scene& scene, const Capture& capture, const RadianceSamples& samples,
                    const std::vector<uint8_t>& taken, EmitterCluster& cluster);

}  // namespace relamp
