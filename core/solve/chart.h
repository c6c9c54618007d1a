// A chart of 24 patches in a photograph, as patches of known albedo.
#pragma once
#include <array>
#include <vector>

#include "solve/known_patch.h"

namespace relamp {

/// Its patches row by row from dark skin. `corners`: pixels of the middles of dark skin, bluish green, black and white,
/// round the chart; perspective is undone. Albedo: linear Rec.709 under D65. Grey patches are told to 3 %, coloured
/// ones to 15 %, because a camera's channels are not the chart's. Throws Error when the corners are no convex shape.
std::vector<KnownPatch> chartPatches(size_t view, const std::array<Vec2, 4>& corners);

}  // namespace relamp
