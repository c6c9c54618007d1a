#include "viewport/gpu_mesh.h"

namespace relamp::ui {

bool GpuMesh::upload(const std::shared_ptr<const Mesh>& mesh, const std::vector<uint8_t>& visible,
                     uint64_t visibleVersion) {
    const bool otherMesh = mesh != mesh_, otherTriangles = otherMesh || visibleVersion != visibleVersion_;
    if (!otherTriangles) return false;
    // An emitter that moves brings a new mesh with the same triangles: then only places travel.
    const bool sameTopology =
        otherMesh && mesh_ && visibleVersion == visibleVersion_ && mesh->triangles == mesh_->triangles;
    glBindVertexArray(array_.id());
    if (otherMesh) {
        positions_.upload(GL_ARRAY_BUFFER, mesh->positions);
        normals_.upload(GL_ARRAY_BUFFER, mesh->normals);
    }
    if (!sameTopology) {
        if (visible.empty()) {
            indices_.upload(GL_ELEMENT_ARRAY_BUFFER, mesh->triangles);
            indexCount_ = 3 * mesh->triangles.size();
        } else {
            std::vector<Triangle> shown;
            shown.reserve(mesh->triangles.size());
            for (size_t t = 0; t < mesh->triangles.size(); ++t)
                if (visible[t]) shown.push_back(mesh->triangles[t]);
            indices_.upload(GL_ELEMENT_ARRAY_BUFFER, shown);
            indexCount_ = 3 * shown.size();
        }
    }
    glBindVertexArray(0);
    mesh_ = mesh;
    visibleVersion_ = visibleVersion;
    return !sameTopology;
}

void GpuMesh::bindGeometry() {
    glBindVertexArray(array_.id());
    glEnableVertexAttribArray(0);
    glBindBuffer(GL_ARRAY_BUFFER, positions_.id());
    glVertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, 0, nullptr);
    glEnableVertexAttribArray(1);
    glBindBuffer(GL_ARRAY_BUFFER, normals_.id());
    glVertexAttribPointer(1, 3, GL_FLOAT, GL_FALSE, 0, nullptr);
}

void GpuMesh::draw(GlBuffer* colours, bool textured) {
    if (!indexCount_) return;
    bindGeometry();
    bindColours(colours);
    glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, indices_.id());
    if (textured) {
        glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, positions_.id());
        glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 1, indices_.id());
        glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 2, texcoords_.id());
    }
    glDrawElements(GL_TRIANGLES, GLsizei(indexCount_), GL_UNSIGNED_INT, nullptr);
    glBindVertexArray(0);
}

void GpuMesh::bindColours(GlBuffer* colours) {
    if (!colours) return glDisableVertexAttribArray(2);
    glEnableVertexAttribArray(2);
    glBindBuffer(GL_ARRAY_BUFFER, colours->id());
    glVertexAttribPointer(2, 3, GL_FLOAT, GL_FALSE, 0, nullptr);
}

void GpuMesh::drawSubset(GlBuffer& indices, size_t count, GlBuffer* colours) {
    if (!count) return;
    bindGeometry();
    bindColours(colours);
    glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, indices.id());
    glDrawElements(GL_TRIANGLES, GLsizei(count), GL_UNSIGNED_INT, nullptr);
    glBindVertexArray(0);
}

}  // namespace relamp::ui
