// Seams: where charts end on the texture and the surface goes on.
#pragma once
#include "brdf/albedo_texture.h"
#include "scene/mesh.h"

namespace relamp {

/// One place of the surface, as it lies in two charts; texels.
struct SeamPoint {
    Vec2 here, there;
};

/// Places on all edges between triangles whose charts differ, about one a texel. Vertices with one position and one
/// normal count as one. Cost: O(triangles log triangles).
std::vector<SeamPoint> seamPoints(const Mesh& captured, const AlbedoTexture& texture);

/// Moves the texels on both sides of the seams until both say the same, by rounds of projection on one place after the
/// other (Kaczmarz). Only texels that touch a seam change.
void levelSeams(const std::vector<SeamPoint>& seams, int rounds, AlbedoTexture& texture);

}  // namespace relamp
