#include "viewport/gpu_scene.h"

#include <epoxy/gl.h>

#include <cstring>

#include "base/error.h"
#include "base/parallel.h"

namespace relamp::ui {
namespace {

/// Copies a list of a mesh; of one that it follows only the runs that differ.
void bring(GpuBuffer& buffer, const std::vector<Vec3>& now, const std::vector<Vec3>* before) {
    constexpr size_t run = 8192;
    if (!before || before->size() != now.size()) {
        buffer.put(now.data(), now.size() * sizeof(Vec3), GL_DYNAMIC_DRAW);
        return;
    }
    std::vector<uint8_t> differs((now.size() + run - 1) / run);
    const auto lengthOf = [&](size_t r) { return std::min(run, now.size() - r * run); };
    parallelFor(differs.size(), 1, [&](size_t r) {
        differs[r] = std::memcmp(&now[r * run], &(*before)[r * run], lengthOf(r) * sizeof(Vec3)) != 0;
    });
    for (size_t r = 0; r < differs.size(); ++r)
        if (differs[r]) buffer.change(r * run * sizeof(Vec3), &now[r * run], lengthOf(r) * sizeof(Vec3));
}

}  // namespace

void GpuScene::takeTrees(const DeviceBlockers& blockers) {
    std::vector<std::shared_ptr<const BoxTree>> now;
    for (const auto& b : blockers.blockers) now.push_back(b.tree);
    if (now == trees_) return;
    trees_.clear();
    places.assign(now.size(), {});
    std::vector<BoxTree::Node> boxes;
    std::vector<Vec4> corners;
    for (size_t b = 0; b < now.size(); ++b) {
        if (!now[b]) continue;
        const auto first = uint32_t(boxes.size()), corner = uint32_t(corners.size() / 3);
        for (BoxTree::Node n : now[b]->nodes) {
            n.skip += first;
            if (n.leaf) n.leaf += corner << 3;
            boxes.push_back(n);
        }
        corners.insert(corners.end(), now[b]->triangles.begin(), now[b]->triangles.end());
        places[b] = {first, uint32_t(boxes.size())};
    }
    context->expectRoom(std::max(boxes.size() * sizeof(BoxTree::Node), corners.size() * sizeof(Vec4)));
    nodes.put(boxes.data(), boxes.size() * sizeof(BoxTree::Node), GL_STATIC_DRAW);
    triangles.put(corners.data(), corners.size() * sizeof(Vec4), GL_STATIC_DRAW);
    context->check();
    trees_ = std::move(now);
}

void GpuScene::take(const DeviceBlockers& blockers, const LiveVertices& vertices) {
    takeTrees(blockers);
    if (mesh_ == vertices.mesh) return;
    const std::shared_ptr<const Mesh> before = std::move(mesh_);
    mesh_.reset();
    context->expectRoom(vertices.count() * sizeof(Vec3));
    bring(positions, vertices.mesh->positions, before ? &before->positions : nullptr);
    bring(normals, vertices.mesh->normals, before ? &before->normals : nullptr);
    context->check();
    mesh_ = vertices.mesh;
}

void GpuScene::clear() {
    for (GpuBuffer* b : {&nodes, &triangles, &positions, &normals}) b->put(nullptr, 0, GL_STATIC_DRAW);
    trees_.clear();
    mesh_.reset();
}

std::shared_ptr<GpuScene> openGpuScene(bool force, std::string* why) {
    std::shared_ptr<GpuContext> context = openGpuContext(force, why);
    return context ? std::make_shared<GpuScene>(std::move(context)) : nullptr;
}

}  // namespace relamp::ui
