#include "viewport/seen_triangles.h"

namespace relamp::ui {

bool SeenTriangles::follow(Renderer& renderer, const EyeView& eye, GpuMesh& mesh, const std::vector<uint8_t>& shown,
                           uint64_t version) {
    const std::shared_ptr<const Mesh>& now = mesh.mesh();
    if (!base_ || clipFromWorld_ != eye.clipFromWorld || width_ != eye.width || height_ != eye.height ||
        version_ != version || base_->triangles != now->triangles) {
        clipFromWorld_ = eye.clipFromWorld, width_ = eye.width, height_ = eye.height, version_ = version;
        base_ = now;
        left_.assign(now->vertexCount(), 0);
        known_ = false;
        return false;
    }
    for (size_t v = 0; v < left_.size(); ++v)
        if (!left_[v] && now->positions[v] != base_->positions[v]) left_[v] = 1, known_ = false;
    if (!known_) look(renderer, eye, mesh, shown);
    return true;
}

void SeenTriangles::look(Renderer& renderer, const EyeView& eye, GpuMesh& mesh, const std::vector<uint8_t>& shown) {
    std::vector<Triangle> standing, drawn;
    for (size_t t = 0; t < base_->triangles.size(); ++t) {
        const Triangle& triangle = base_->triangles[t];
        if (!shown.empty() && !shown[t]) continue;
        const bool left = left_[triangle[0]] || left_[triangle[1]] || left_[triangle[2]];
        (left ? drawn : standing).push_back(triangle);
    }
    indices_.upload(GL_ARRAY_BUFFER, standing);
    const std::vector<uint8_t> seen = renderer.seenTriangles(eye, mesh, indices_, standing.size());
    for (size_t t = 0; t < standing.size(); ++t)
        if (seen[t]) drawn.push_back(standing[t]);
    indices_.upload(GL_ARRAY_BUFFER, drawn);
    count_ = drawn.size();
    known_ = true;
}

}  // namespace relamp::ui
