// A shade as one even sheet, in place of the shreds that opening it leaves.
#pragma once
#include "radiance/round_sheets.h"

namespace relamp {

/// Both sides of the sheet from its rim along its axis to where the mesh goes on as a whole ring, and in `replaced`
/// what the mesh has there. The profile is the surface's, as far off it as the mesh lies, and comes to the rim's edges
/// at its end. Only the first `own` vertices are the mesh's. `low`: the rim is the lower end. None where less than 40 %
/// of the sheet's height is whole, or where the mesh does not lie on the surface. O(vertices + triangles).
std::optional<SurfacePatch> wholeShade(const Scene& scene, size_t own, const RoundSheet& sheet, const RimCircle& rim,
                                       bool low);

}  // namespace relamp
