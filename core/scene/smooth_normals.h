// Shading normals of a noisy mesh: photogrammetry places vertices well and turns faces badly.
#pragma once
#include "scene/mesh.h"

namespace relamp {

/// Normals after `rounds` of averaging with those of neighbours along mesh edges; unlike ones are held apart (weight
/// exp(-|n - m|^2 / 0.36), so that creases of more than some 50 degrees stay) [Tomasi98]. Positions are left alone.
/// Unit. O(rounds x triangles).
std::vector<Vec3> smoothedNormals(const Mesh& mesh, int rounds);

}  // namespace relamp
