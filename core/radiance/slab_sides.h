// Edges of tables and boards: a reconstruction ends them in skirts, crooked, without the sides below.
#pragma once
#include "capture/mesh_mend.h"
#include "radiance/round_sheets.h"

namespace relamp {

struct SlabSides {
    std::vector<MeshMend::MovedVertex> moved;  ///< of the scene: to the edges
    std::vector<uint32_t> removed;             ///< triangles of the scene beyond the edges, ascending
    SurfacePatch sides;                        ///< below the edges, as deep as photographs show them
    size_t edges = 0;
    double depth = 0;  ///< metres: of the deepest side
};

/// Straight rims of flat surfaces where photographs show their edges, and the sides of the slab below them: as deep as
/// its lower edges are, which photographs show as lines alongside. Sides that the mesh has are replaced with them;
/// where no lower edge is shown they stay, and what ends there is an edge without sides. `scene` is without its skirts,
/// `samples` with them, because without one a side looks like background. `isLight`: per vertex, non-zero for those of
/// emitters, which have no sides and stay as they are.
/// O(trials x vertices + cells x views rays).
SlabSides slabSides(const Scene& scene, const Capture& capture, const RadianceSamples& samples,
                    const std::vector<uint8_t>& isLight);

}  // namespace relamp
