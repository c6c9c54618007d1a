// Meshes and per-vertex colours on the graphics card. Positions, normals and colours lie apart: when only light
// changes, only colours travel.
#pragma once
#include <memory>
#include <vector>

#include "scene/mesh_io.h"
#include "viewport/gl_objects.h"

namespace relamp::ui {

class GpuMesh {
public:
    /// Uploads geometry; `visible` per triangle, empty: all. Nothing happens when mesh and `visibleVersion` are those
    /// of the last call.
    /// True where other triangles than before are drawn.
    bool upload(const std::shared_ptr<const Mesh>& mesh, const std::vector<uint8_t>& visible, uint64_t visibleVersion);
    /// Texture coordinates of the triangles that are drawn, in their order; outside [0, 1]: none.
    void uploadTexcoords(const std::vector<FaceTexcoords>& texcoords) {
        texcoords_.upload(GL_SHADER_STORAGE_BUFFER, texcoords);
    }
    const std::shared_ptr<const Mesh>& mesh() const { return mesh_; }
    size_t vertexCount() const { return mesh_ ? mesh_->vertexCount() : 0; }
    /// Binds everything and draws. `colours`: a buffer of one RGB a vertex; null: none. `textured`: the shader finds
    /// positions, corners and texture coordinates in storage buffers 0 to 2.
    void draw(GlBuffer* colours, bool textured = false);
    /// The same without a texture, with an index buffer of the caller's.
    void drawSubset(GlBuffer& indices, size_t count, GlBuffer* colours = nullptr);

private:
    std::shared_ptr<const Mesh> mesh_;
    uint64_t visibleVersion_ = ~uint64_t(0);
    GlVertexArray array_;
    GlBuffer positions_, normals_, indices_, texcoords_;
    size_t indexCount_ = 0;
    void bindGeometry();
    void bindColours(GlBuffer* colours);
};

}  // namespace relamp::ui
