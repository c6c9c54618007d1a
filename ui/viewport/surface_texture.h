// The texture of an estimate for the viewport: a factor on what the vertices show, or in place of it. Pure; no GL.
#pragma once
#include "scene/mesh_io.h"
#include "solve/estimate.h"

namespace relamp::ui {

/// Albedo per texel over albedo between the vertices; 1 where neither says anything.
struct SurfaceDetail {
    int width = 0, height = 0;
    std::vector<Vec4> factor;  ///< row 0 at the top; the last channel is 1
};

/// Of an estimate with a texture; halved until no side exceeds 4096, which every graphics card holds.
SurfaceDetail detailOf(const Estimate& estimate, const Mesh& captured);

/// Colours that stand in place of those of the vertices, of an estimate with a texture, at most 2048 a side: what
/// confidenceColours and correctionColours are on vertices. The first are display values; without a confidence per
/// texel they are empty (width 0).
SurfaceDetail confidenceDetail(const Estimate& estimate);
SurfaceDetail correctionDetail(const Estimate& estimate, const Mesh& captured);

/// Where the triangles of an edited mesh lie in the texture, in [0, 1] with v down; negative for those that have no
/// texels. `origin`: the capture's vertex that each vertex stands for; null: the mesh is the capture's. `visible`: per
/// triangle, empty: all; others are left out of the list.
std::vector<FaceTexcoords> texcoordsDrawn(const AlbedoTexture& texture, const Mesh& mesh, const Mesh& captured,
                                          const std::vector<uint32_t>* origin, const std::vector<uint8_t>& visible);

}  // namespace relamp::ui
