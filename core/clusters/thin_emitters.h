// Emitters that are too thin for their vertices to hold one clean observation: a strip of light of two pixels. Inner
// part of the clusters, not a door.
#pragma once
#include "clusters/patches.h"

namespace relamp {

struct ThinEmitter {
    std::vector<uint32_t> triangles;  ///< sorted; with what is hidden of components that are mostly bright
    Rgb radiance{0};                  ///< median over the views of each view's brighter pixels
    float radianceSigma = 0;          ///< relative; large where no pixel is covered whole
    EmitterEvidence evidence;
};

/// Connected triangles without a clean observation whose pixels are brighter than `floor`, in most of the views that
/// see them and in two at least. None has a vertex in `except`. O(pixels).
std::vector<ThinEmitter> thinEmitters(const Scene& scene, const Capture& capture, const RadianceSamples& samples,
                                      const std::vector<VertexRadiance>& seen, float floor,
                                      const std::vector<uint8_t>& except);

}  // namespace relamp
