// A shot's surfaces: reflectance.ply for the vertices of the capture's mesh, added.ply for those that were added to it.
#pragma once
#include <filesystem>

#include "scene/mesh_io.h"
#include "shot/shot_file.h"

namespace relamp {

/// Writes reflectance.ply and, where surfaces were added to the mesh, added.ply with the same columns. Balls that were
/// fitted to photographs are in neither. Whole or not at all; throws Error naming the file.
void writeReflectance(const Shot& shot, const Mesh& mesh, const std::filesystem::path& folder);

/// The mesh of both files. Throws Error naming the file.
Mesh readShotMesh(const std::filesystem::path& folder, MeshReport& report);

/// What both files say of the vertices of a capture's mesh.
class ReflectanceFiles {
public:
    /// `added`: vertices that were added to the file's mesh. Throws Error naming the file.
    ReflectanceFiles(const std::filesystem::path& folder, const Capture& capture, size_t added);

    /// One value a vertex of the mesh, `missing` for those of fitted balls. Throws Error when there is no such column,
    /// or not one finite value a vertex.
    std::vector<float> column(const std::string& name, float missing = 0) const;
    Reflectance reflectance(const BrdfBasis& basis) const;
    /// Radiance of each vertex of an emitter in parts of the emitter's; empty where the files have none.
    std::vector<float> emissionLevel() const;
    /// Of so many emitters; empty where the files have none.
    NearFieldCorrection nearFieldCorrection(size_t emitters) const;
    /// Their vertices are numbered as the mesh's.
    std::vector<TexturedFace> texturedFaces() const;

private:
    bool has(const std::string& name) const;

    std::filesystem::path folder_;
    size_t vertices_, written_;  ///< of the mesh: all, and those that have a place in the files
    size_t firstAdded_, added_;  ///< of the mesh
    std::vector<VertexProperty> own_, ofAdded_;
};

}  // namespace relamp
