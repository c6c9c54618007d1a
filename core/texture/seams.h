// Seams: where charts end on the texture and the surface goes on.
#pragma once
#include "brdf/albedo_texture.h"
#include "scene/mesh.h"

namespace relamp {

/// One place of the surface, as it lies in two charts; texels.
struct SeamPoint {
    Vec2 here, there;
    bool crease = false;  ///< the surface turns there by more than 30 degrees
};

/// Places on all edges between triangles whose charts differ, about so many a texel. Vertices with one position and one
/// normal count as one. Cost: O(triangles log triangles).
std::vector<SeamPoint> seamPoints(const Mesh& captured, const AlbedoTexture& texture, float perTexel = 1);

/// Whether one thing goes on across the seam, which both sides should say alike. At creases, where things end, colours
/// may differ: sides that are more than a fifth apart do.
bool goesOn(const SeamPoint& place, const AlbedoTexture& texture);

/// Moves the texels on both sides of the seams until both say the same: the least change that does, by conjugate
/// gradients. Places where nothing goes on stay as they are. Only texels that touch a seam change; those that would
/// leave [0, 2] stay at its ends, and the others make up for them. Places should be closer together than texels, or
/// sides differ between them. The same bits on any number of threads.
void levelSeams(const std::vector<SeamPoint>& seams, AlbedoTexture& texture);

}  // namespace relamp
