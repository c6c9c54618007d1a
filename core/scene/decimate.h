// A large mesh brought to a working size, and what was found there carried back to the large one.
#pragma once
#include "base/progress.h"
#include "scene/mesh.h"

namespace relamp {

/// A point of a mesh's surface.
struct SurfacePlace {
    static constexpr uint32_t none = 0xffffffff;
    uint32_t triangle = none;  ///< none: the vertex belongs to no face
    Vec3 weight{0};            ///< of its corners, together 1
};

struct DecimatedMesh {
    Mesh mesh;                         ///< some of the large mesh's vertices, in its order, at their places
    std::vector<uint32_t> vertex;      ///< which they are
    std::vector<SurfacePlace> places;  ///< where each vertex of the large mesh lies on it
};

/// Edge collapses in the order of the error they make [Garland97], each onto one of its ends, until `triangles` are
/// left or none is allowed. Vertices at one place are one (seams do not tear), rims of holes collapse along themselves
/// only, edges of three or more faces stay, no triangle turns over by more than 70 degrees, components keep at least 64
/// faces, and no edge becomes longer than three times what even triangles of that number would have: colours and
/// shadows are looked up at vertices. Normals are means over what a vertex stands for, unlike ones (45 degrees) left
/// out. Faces may be turned either way. Deterministic, one thread. Cost: n log n, about 10 s and 400 MiB for a million
/// triangles. Throws Cancelled.
DecimatedMesh decimate(const Mesh& mesh, size_t triangles, Progress& progress);

}  // namespace relamp
