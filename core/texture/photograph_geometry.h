// What each pixel of a photograph sees, and how far from the edge of what it sees it lies.
#pragma once
#include "base/progress.h"
#include "capture/capture.h"
#include "scene/scene.h"

namespace relamp {

struct PhotographGeometry {
    int width = 0, height = 0;
    std::vector<uint32_t> triangle;  ///< at the pixel's centre; Hit::none where no surface is
    std::vector<float> depth;        ///< metres along the ray
    std::vector<float> trust;        ///< in [0, 1]: 0 unusable, clipped or on an edge; rises within three pixels of it
    size_t surfacePixels = 0;        ///< with trust

    float weight(int x, int y) const { return trust[size_t(y) * size_t(width) + size_t(x)]; }
};

/// One a view. Edges are where depth jumps, where the surface ends, and where an emitter begins. Cost: one ray a pixel.
std::vector<PhotographGeometry> photographGeometry(const Capture& capture, const Scene& scene,
                                                   const std::vector<int>& emitterOfTriangle, Progress& progress);

}  // namespace relamp
