// Charts: triangles of a mesh in groups that are flat enough to be projected on a plane.
#pragma once
#include "texture/atlas.h"

namespace relamp {

/// Triangles beside each triangle across its three edges; noNeighbour at rims and where more than two meet.
constexpr uint32_t noNeighbour = ~0u;
std::vector<std::array<uint32_t, 3>> trianglesBeside(const Mesh& mesh);

/// Triangles on a plane of their own.
struct Chart {
    std::vector<uint32_t> triangles;
    std::vector<std::array<Vec2, 3>> corners;  ///< of each, texels from the chart's lower corner
    float density = 0;                         ///< texels per metre
    Vec2 extent{0};                            ///< texels
};

/// Every triangle with a density is in exactly one chart. Grown from triangle to neighbour; a triangle that would cover
/// another one of its chart, or come within a texel of another layer of the surface, starts a new chart. Cost: 4 us a
/// triangle. Memory: 4 B for each of 16 parts of a texel of the present chart, at most 120 MB, or 4 B a texel.
std::vector<Chart> growCharts(const Mesh& mesh, const std::vector<float>& texelsPerMetre, const AtlasOptions& options,
                              Progress& progress);

}  // namespace relamp
