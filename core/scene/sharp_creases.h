// Creases: a reconstruction rounds them over two or three edges, where neither normals nor places are the surface's.
#pragma once
#include "scene/scene.h"

namespace relamp {

/// A vertex that is brought to the side of a crease that it belongs to.
struct CreaseVertex {
    uint32_t vertex = 0;
    Vec3 position{0};  ///< metres: on that side, and beside the crease itself where an edge crosses it
    Vec3 normal{0};    ///< unit: that side's
    Vec3 middle{0};    ///< unit: half way to the other side's normal at the crease itself, else `normal`
};

/// Where two smooth sides meet at 35 degrees or more: within six edges of a vertex, most of the surface faces within 10
/// degrees of one of two directions and lies flat. The smaller side may bend around the normal of the other, by 53
/// degrees either way, as drums do that stand on something. A vertex belongs to the nearer side. Vertices of edges that
/// cross the crease slide along their side to the crease, so that it is as sharp and as straight as the sides say.
/// Corners of three sides, and all that is bumpy on the scale of a few edges, stay. `places`: where the scene's
/// vertices are taken to lie, metres. `sides`: normals of vertices whose side is known, which keep it, and 0 of others;
/// empty: none is. Vertices of `leftOut` (non-zero: lights) are of no side and stay. Ascending.
/// O(vertices beside creases x faces within six edges, squared).
std::vector<CreaseVertex> sharpCreases(const Scene& scene, const std::vector<Vec3>& places,
                                       const std::vector<Vec3>& sides, const std::vector<uint8_t>& leftOut);

}  // namespace relamp
