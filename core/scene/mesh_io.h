// Meshes on disk: PLY, OBJ, STL, OFF. A tolerant triangle-soup reader stands in front of OpenMesh, which drops
// non-manifold faces; OpenMesh is named only in mesh_io.cpp.
#pragma once
#include <filesystem>

#include "scene/mesh.h"

namespace relamp {

struct MeshLimits {
    size_t maxVertices = 50'000'000, maxTriangles = 100'000'000;
};

/// Reads a mesh and repairs what can be repaired (see MeshReport). Throws Error naming the file and the field: missing,
/// not a mesh, counts beyond the limits or beyond what the file's size can hold, no triangles left.
Mesh readMesh(const std::filesystem::path& file, MeshReport* report = nullptr, const MeshLimits& limits = {});

/// One named float per vertex, to be written beside x y z.
struct VertexProperty {
    std::string name;
    std::vector<float> values;
    bool asInt = false;   ///< written as int
};

/// Writes a binary little-endian PLY with positions, normals, the properties in order, and the faces. Whole or not at all.
void writeVertexPly(const std::filesystem::path& file, const Mesh& mesh, const std::vector<VertexProperty>& properties);

/// Reads the vertex properties of a PLY (binary little-endian or ascii) by name. Throws Error naming file and property.
std::vector<VertexProperty> readVertexPly(const std::filesystem::path& file);

}  // namespace relamp
