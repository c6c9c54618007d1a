// What the mesh readers give: triangles as the file has them, before anything is repaired.
#pragma once
#include <cstdint>
#include <string_view>
#include <vector>

#include "base/math.h"
#include "scene/mesh.h"
#include "scene/mesh_io.h"

namespace relamp {

/// Vertices and triangles in file order; corners that name no vertex and vertices that are not finite are still in.
struct TriangleSoup {
    static constexpr uint32_t noVertex = ~0u;  ///< a corner whose index lies outside the file's vertices
    std::vector<DVec3> positions;  ///< as the file has them: double, because scenes lie far from their origin
    std::vector<Vec3> normals;     ///< as many as positions, or empty; not normalised, zero where the file gives none
    std::vector<Triangle> triangles;
    std::vector<FaceTexcoords> texcoords;  ///< of the first triangles; those behind have none
    std::vector<int> images;               ///< of MeshPaint::images, as many as texcoords
    int image = -1;                        ///< that faces added from here on have
    MeshPaint paint;                       ///< as many colours as positions, or none
    bool yUp = false;                      ///< as MeshReport's
    size_t polygons = 0;                   ///< faces of more than three corners, cut into fans
    size_t badIndexFaces = 0;  ///< faces with a corner outside the vertices, or fewer than three corners: dropped

    /// Appends a face of any number of corners as a fan. Indices are checked against `vertices`. `places`: texture
    /// coordinates, one a corner; null where the face has none.
    void addFace(const std::vector<int64_t>& corners, size_t vertices, const MeshLimits& limits,
                 const std::vector<Vec2>* places = nullptr);
};

/// The readers take the whole file's bytes and throw Error without the file's name. Counts are held against the bytes
/// that are there before memory is asked for.
/// `file`: for the files that it names.
TriangleSoup readPly(std::string_view bytes, const std::filesystem::path& file, const MeshLimits& limits);
TriangleSoup readObj(std::string_view bytes, const std::filesystem::path& file, const MeshLimits& limits);
TriangleSoup readOff(std::string_view bytes, const MeshLimits& limits);
TriangleSoup readBinaryOff(std::string_view bytes, const MeshLimits& limits);
TriangleSoup readStl(std::string_view bytes, const MeshLimits& limits);
TriangleSoup readGltf(std::string_view bytes, const std::filesystem::path& file, const MeshLimits& limits);

/// Drops faces that are no surface, fills in normals, turns faces round that are turned against the file's normals at
/// all their corners, counts what is left (see MeshReport). Vertices keep their order; those that are not finite are
/// moved to the middle of the others. `recentre`: a mesh far from its origin is moved near it (MeshReport::origin).
/// Throws Error when no triangle is left.
Mesh repairSoup(TriangleSoup&& soup, bool recentre, MeshReport& report);

}  // namespace relamp
