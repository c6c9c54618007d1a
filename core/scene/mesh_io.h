// Meshes on disk: PLY, OBJ, glTF, STL, OFF. A tolerant triangle-soup reader stands in front of OpenMesh, which drops
// non-manifold faces; OpenMesh is named only in mesh_io.cpp.
#pragma once
#include <filesystem>

#include "scene/mesh.h"

namespace relamp {

struct MeshLimits {
    size_t maxVertices = 50'000'000, maxTriangles = 100'000'000;
};

/// Reads a mesh and repairs what can be repaired (see MeshReport). Throws Error naming the file and the field: missing,
/// not a mesh, counts beyond the limits or beyond what the file's size can hold, no triangles left. Files are read in
/// double. With a `report` that can say so, a mesh that lies farther from the origin than twice its size is moved near
/// it, so that single precision holds it (report->origin). `texcoords`, if not null, becomes the faces that have
/// texture coordinates in the file, also those that were dropped. `paint`, if not null, becomes what the file says of
/// colours; no image is opened, and one that is named wrongly is none.
Mesh readMesh(const std::filesystem::path& file, MeshReport* report = nullptr, const MeshLimits& limits = {},
              std::vector<TexturedFace>* texcoords = nullptr, MeshPaint* paint = nullptr);

/// Larger files are refused.
constexpr size_t mostMeshBytes = size_t(1) << 36;

/// Files that a mesh is made of besides its own: a glTF's buffers, materials, images. None where it cannot be read.
std::vector<std::filesystem::path> filesBesideMesh(const std::filesystem::path& file);

/// Where the positions of a mesh in this box are to count from: 0 for one about the origin; for one farther from it
/// than twice its size its middle, in whole steps of a power of two, so that adding it again is exact.
DVec3 originFor(const DVec3& low, const DVec3& high);

/// One named float per vertex, to be written beside x y z.
struct VertexProperty {
    std::string name;
    std::vector<float> values;
    bool asInt = false;  ///< written as int
};

/// Writes a binary little-endian PLY with positions, normals, the properties in order, and the faces. Whole or not at
/// all. `origin` is added to the positions, which are then written as doubles unless it is 0. `texcoords`: one a face,
/// or none; written as a list `texcoord` of six numbers, as MeshLab does.
void writeVertexPly(const std::filesystem::path& file, const Mesh& mesh, const std::vector<VertexProperty>& properties,
                    const DVec3& origin = DVec3(0), const std::vector<FaceTexcoords>& texcoords = {});

/// The faces of a PLY that have texture coordinates. Empty where none has. Throws Error naming the file.
std::vector<TexturedFace> readTexturedFaces(const std::filesystem::path& file);

/// Reads the vertex properties of a PLY (binary little-endian or ascii) by name. Throws Error naming file and property.
std::vector<VertexProperty> readVertexPly(const std::filesystem::path& file);

}  // namespace relamp
