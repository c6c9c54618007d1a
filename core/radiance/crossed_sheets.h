// Two sides of a thin sheet that have passed through one another: errors of a mesh move each along its own normal.
#pragma once
#include "capture/mesh_mend.h"
#include "radiance/samples.h"

namespace relamp {

struct CrossedSheets {
    std::vector<MeshMend::MovedVertex> moved;  ///< ascending
    size_t crossed = 0;                        ///< vertices that lie past the other side
    float deepest = 0;                         ///< metres: the 95th percentile of how far
};

/// Vertices that face another surface within 3 % of the diagonal, of regions of which a photograph would see backs.
/// Each half moves along its normal until the sheet is 0.1 % of the diagonal thick. `leftOut`, per vertex: stay as they
/// are. Components most of whose vertices face another so are inside out, not crossed, and stay too. None where fewer
/// than 20 are found. O(pixels + views x triangles), and two rays a vertex and round where backs are seen.
CrossedSheets crossedSheets(const Scene& scene, const Capture& capture, const RadianceSamples& samples,
                            const std::vector<uint8_t>& leftOut);

}  // namespace relamp
