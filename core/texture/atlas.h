// A mesh laid out flat: charts of connected triangles that face alike, side by side in one image.
#pragma once
#include "base/progress.h"
#include "scene/mesh.h"

namespace relamp {

struct AtlasOptions {
    int mostSide = 4096;         ///< texels; resolution falls where the charts would need more
    float mostTurn = 50;         ///< degrees: by which the faces of a chart may turn away from its plane
    float mostDensityRatio = 2;  ///< between the finest and the coarsest triangle of a chart
    int gutter = 2;              ///< texels around each chart, so that bilinear reading never meets another one
};

struct Atlas {
    int width = 0, height = 0;                 ///< texels; 0 where no triangle asked for any
    std::vector<std::array<Vec2, 3>> corners;  ///< per triangle, texels; negative where it has none
    std::vector<uint32_t> chartOf;             ///< per triangle; meaningless where it has no texels
    size_t charts = 0;
    float scale = 1;  ///< of the density that was asked for, at most 1
};

/// Charts are projected along their mean normal, so lengths are kept within a factor of cos(mostTurn); no two triangles
/// of a chart cover one texel. `texelsPerMetre`: per triangle, 0 leaves it out. Rectangles are packed by
/// stb_rect_pack's skyline. Cost: O(triangles + texels), about 1 s for 200k triangles. Throws Cancelled, and Error
/// where the charts do not fit at any resolution.
Atlas layOut(const Mesh& mesh, const std::vector<float>& texelsPerMetre, const AtlasOptions& options,
             Progress& progress);

}  // namespace relamp
