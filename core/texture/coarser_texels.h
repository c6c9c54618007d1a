// What a texture looks like from afar: smaller copies, and the mean of each triangle.
#pragma once
#include "brdf/albedo_texture.h"

namespace relamp {

/// Fills texture.coarser and texture.ofTriangle from its texels. Texels outside of charts count nothing, except beside
/// them. Cost: O(texels + triangles), 0.3 s for 4096 x 4096. Memory: 4 B a texel, 5 B more meanwhile. The same bits on
/// any number of threads.
void addCoarser(AlbedoTexture& texture);

}  // namespace relamp
