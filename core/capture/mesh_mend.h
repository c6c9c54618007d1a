// What is put right in a capture's mesh before it is used; the file stays as it is.
#pragma once
#include <vector>

#include "scene/mesh.h"

namespace relamp {

struct MeshMend {
    struct MovedVertex {
        uint32_t vertex = 0;
        Vec3 position{0};  ///< metres, Z up, counted from the capture's origin
        bool operator==(const MovedVertex&) const = default;
    };
    struct TurnedVertex {
        uint32_t vertex = 0;
        Vec3 normal{0};  ///< unit
        bool operator==(const TurnedVertex&) const = default;
    };
    std::vector<uint32_t> removed;     ///< triangles of the file, ascending
    std::vector<uint32_t> shadowless;  ///< the same: they stay and light passes them
    std::vector<MovedVertex> moved;    ///< vertices of the file, and of what is added to it
    std::vector<TurnedVertex> turned;  ///< vertices of the file with normals of their own
    std::vector<uint32_t> shining;  ///< vertices that send the light of the emitter they are connected with, ascending
    std::vector<uint32_t> bothSides;   ///< vertices of emitters whose backs shine as their fronts do, ascending
    std::vector<Vec3> addedPositions;  ///< vertices that follow the file's; metres, as above
    std::vector<Triangle> added;       ///< of them, counted from the first of them

    /// Whether the surface or its shadows are other than in the file.
    bool reshapes() const {
        return !(removed.empty() && shadowless.empty() && moved.empty() && turned.empty() && shining.empty() &&
                 added.empty());
    }
    bool empty() const { return !reshapes() && bothSides.empty(); }
    bool operator==(const MeshMend&) const = default;
};

/// What the triangles that are left, of `triangles` of the file, are called there.
std::vector<uint32_t> trianglesLeft(const MeshMend& mend, size_t triangles);

/// Moves the vertices, takes the triangles away and adds the others behind those that are left; vertices keep their
/// numbers. Normals of moved ones stay, but for those that are given and those whose faces turn by more than 20
/// degrees. Throws Error for a vertex or triangle that the mesh does not have, and for a position or normal that is not
/// finite. O(triangles).
void applyMend(const MeshMend& mend, Mesh& mesh);

}  // namespace relamp
