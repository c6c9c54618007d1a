// Cells of a surface: some dozen vertices each that belong together, with borders where colour or shape changes.
#pragma once
#include "scene/scene.h"

namespace relamp {

constexpr uint32_t noCell = ~0u;

struct CellBorder {
    uint32_t a = 0, b = 0;  ///< cells, a < b
    double alike = 0;       ///< sum over the mesh's edges across it: 1 where nothing changes, 0.05 at least
};

struct SurfaceCells {
    std::vector<uint32_t> cellOf;  ///< per vertex; noCell where there is none
    uint32_t count = 0;
    std::vector<CellBorder> borders;
};

struct CellOptions {
    uint32_t vertices = 40;  ///< of a cell, about
    uint32_t most = 4000;    ///< cells, about
    float hue = 0.06f;       ///< difference of log chroma that parts two vertices
    float hollow = 0.15f;    ///< turn of the normal along a concave edge, radians, that does: objects meet there
    uint64_t seed = 1;
};

/// Vertices nearest to seeds along the mesh, where steps across changes of hue and through concave creases, where
/// objects meet [HoffmanRichards84], count up to five times their length. `colour`: per vertex, 0 where it is not
/// known. `skip`: per vertex 1 where there is no cell. Rests on places, not on the order of vertices.
/// Cost: O(n log n), 0.1 s for 60000 vertices.
SurfaceCells surfaceCells(const Scene& scene, const std::vector<Rgb>& colour, const std::vector<uint8_t>& skip,
                          const CellOptions& options);

}  // namespace relamp
