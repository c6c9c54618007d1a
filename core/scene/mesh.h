// The scene's surface: an indexed triangle soup with per-vertex normals. No topology is required.
#pragma once
#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "base/math.h"

namespace relamp {

using Triangle = std::array<uint32_t, 3>;

/// Vertices in the file's order (reflectance.ply keeps that order); unusable ones stay as unreferenced places.
struct Mesh {
    std::vector<Vec3> positions;  ///< metres, world
    std::vector<Vec3> normals;    ///< unit, per vertex; (0,0,1) where a vertex has no face
    std::vector<Triangle> triangles;
    std::vector<uint32_t> shadowless = {};  ///< triangles that cameras see and light passes, ascending
    size_t vertexCount() const { return positions.size(); }
    Vec3 faceNormal(size_t t) const {
        const Triangle& i = triangles[t];
        const Vec3 n = glm::cross(positions[i[1]] - positions[i[0]], positions[i[2]] - positions[i[0]]);
        const float length = glm::length(n);
        return length > 0 ? n / length : Vec3(0, 0, 1);
    }
    float triangleArea(size_t t) const {
        const Triangle& i = triangles[t];
        return 0.5f * glm::length(glm::cross(positions[i[1]] - positions[i[0]], positions[i[2]] - positions[i[0]]));
    }
};

/// Texture coordinates of a face's corners: u to the right, v up, both in [0, 1] on the image; all 0 for a face without
/// any.
using FaceTexcoords = std::array<Vec2, 3>;

/// A face with its texture coordinates.
struct TexturedFace {
    Triangle corners;
    FaceTexcoords texcoords;
    int image = -1;  ///< of MeshPaint::images; -1: none
};

/// An image that a mesh's file names, or that lies in a file among other bytes.
struct MeshImage {
    std::filesystem::path file;
    size_t begin = 0, size = 0;  ///< of its bytes; a size of 0: the whole file
    bool operator==(const MeshImage&) const = default;
};

/// How a mesh's own file paints its surface: with images, by texture coordinates, or a colour for each vertex.
struct MeshPaint {
    std::vector<MeshImage> images;
    std::vector<Vec3> colours;  ///< per vertex, 0 to 1; empty: none
    bool linear = false;        ///< `colours` are linear, else as sRGB encodes them
    bool empty() const { return images.empty() && colours.empty(); }
};

/// What the loader found and repaired.
struct MeshReport {
    size_t vertices = 0, triangles = 0;  ///< kept
    size_t nanVertices = 0;              ///< not finite: their faces are dropped
    size_t badIndexFaces = 0;            ///< faces naming a vertex that does not exist: dropped
    size_t degenerateFaces = 0;          ///< zero area or repeated corner: dropped
    size_t duplicateFaces = 0;           ///< same corners, or same place and turn: one stays
    size_t polygons = 0;                 ///< faces of more than three corners, cut into fans
    size_t unreferencedVertices = 0;
    size_t nonManifoldEdges = 0;  ///< edges of three or more faces: kept, counted
    size_t boundaryEdges = 0;     ///< edges of one face: holes
    bool normalsFromFile = false;
    bool yUp = false;  ///< the file's format has Y up, whatever the files beside it have
    DVec3 origin{
        0};  ///< of the file that the mesh's positions count from, file units: 0 unless the mesh lies far from it
};

/// Vertices joined by an edge, in compressed rows: neighbours of v are `to[start[v]] ... to[start[v + 1] - 1]`, sorted.
/// Vertices at the same position (seams) are joined as well.
struct VertexGraph {
    std::vector<uint32_t> start, to;
};
/// `axes` (Scene::axes): so that what chooses among such vertices does not rest on how the world lies.
VertexGraph buildVertexGraph(const Mesh& mesh, const Mat3& axes = Mat3(1));

/// Connected components of the mesh: component of each vertex (0...), unreferenced vertices are components of their
/// own.
std::vector<uint32_t> connectedComponents(const VertexGraph& graph, uint32_t* count = nullptr);

/// Area-weighted vertex normals from the faces.
std::vector<Vec3> vertexNormalsFromFaces(const Mesh& mesh);

}  // namespace relamp
