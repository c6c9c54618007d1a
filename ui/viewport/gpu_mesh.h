// Meshes and per-vertex colours on the graphics card. Positions, normals and colours lie apart: when only light
// changes, only colours travel.
#pragma once
#include <memory>
#include <vector>

#include "scene/mesh.h"
#include "viewport/gl_objects.h"

namespace relamp::ui {

class GpuMesh {
public:
    /// Uploads geometry; `visible` per triangle, empty: all. Nothing happens when mesh and `visibleVersion` are those
    /// of the last call.
    void upload(const std::shared_ptr<const Mesh>& mesh, const std::vector<uint8_t>& visible, uint64_t visibleVersion);
    const std::shared_ptr<const Mesh>& mesh() const { return mesh_; }
    size_t vertexCount() const { return mesh_ ? mesh_->vertexCount() : 0; }
    /// Binds everything and draws. `colours`: a buffer of one RGB a vertex; null: none.
    void draw(GlBuffer* colours);
    /// The positions as they are, with an index buffer of the caller's.
    void drawSubset(GlBuffer& indices, size_t count);

private:
    std::shared_ptr<const Mesh> mesh_;
    uint64_t visibleVersion_ = ~uint64_t(0);
    GlVertexArray array_;
    GlBuffer positions_, normals_, indices_;
    size_t indexCount_ = 0;
    void bindGeometry();
};

}  // namespace relamp::ui
