// Texture coordinates of a file's faces, for the triangles that a mesh has now.
#pragma once
#include "scene/mesh.h"

namespace relamp {

/// Per triangle what the face of the same vertices has, whatever their order; all 0 where there is none. Of several
/// faces the first counts. Cost: O(n log n).
std::vector<FaceTexcoords> texcoordsOf(const std::vector<TexturedFace>& faces, const std::vector<Triangle>& triangles);

}  // namespace relamp
