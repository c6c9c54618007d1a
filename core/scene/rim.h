// Where a mesh ends: the rims of its holes and open sheets.
#pragma once
#include "scene/mesh.h"

namespace relamp {

/// 1 for vertices on an edge that only one face has; vertices at one place count as one, so that seams are no rims.
/// Cost: n log n.
std::vector<uint8_t> rimVertices(const Mesh& mesh);

}  // namespace relamp
