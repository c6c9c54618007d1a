// What vertices say, as texels: where a texture starts from, and what it is compared with.
#pragma once
#include "brdf/albedo_texture.h"
#include "scene/mesh.h"

namespace relamp {

/// Values of the vertices, interpolated at each texel's centre; texels just outside a chart have those of its edge, the
/// others 0. One value a texel of `texture`, whose own texels are not read. `inside`, if not null, becomes 1 for texels
/// whose centres lie on a triangle. Cost: O(triangles + texels).
std::vector<Rgb> texelsOfVertices(const Mesh& mesh, const std::vector<Rgb>& values, const AlbedoTexture& texture,
                                  std::vector<uint8_t>* inside = nullptr);

}  // namespace relamp
