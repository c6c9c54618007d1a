#include "capture/mesh_mend.h"

#include "base/error.h"

namespace relamp {

std::vector<uint32_t> trianglesLeft(const MeshMend& mend, size_t triangles) {
    std::vector<uint8_t> removed(triangles, 0);
    for (const uint32_t t : mend.removed)
        if (t < triangles) removed[t] = 1;
    std::vector<uint32_t> left;
    for (uint32_t t = 0; t < triangles; ++t)
        if (!removed[t]) left.push_back(t);
    return left;
}

void applyMend(const MeshMend& mend, Mesh& mesh) {
    for (const MeshMend::MovedVertex& m : mend.moved) {
        if (m.vertex >= mesh.vertexCount() || !isFinite(m.position))
            throw Error("mesh correction: vertex {} of {} at {:g} {:g} {:g}", m.vertex, mesh.vertexCount(),
                        m.position.x, m.position.y, m.position.z);
        mesh.positions[m.vertex] = m.position;
    }
    const auto marked = [&](const std::vector<uint32_t>& triangles) {
        std::vector<uint8_t> mark(mesh.triangles.size(), 0);
        for (const uint32_t t : triangles) {
            if (t >= mark.size()) throw Error("mesh correction: triangle {} of {}", t, mark.size());
            mark[t] = 1;
        }
        return mark;
    };
    const std::vector<uint8_t> removed = marked(mend.removed), shadowless = marked(mend.shadowless);
    size_t kept = 0;
    for (size_t t = 0; t < mesh.triangles.size(); ++t) {
        if (removed[t]) continue;
        if (shadowless[t]) mesh.shadowless.push_back(uint32_t(kept));
        mesh.triangles[kept++] = mesh.triangles[t];
    }
    mesh.triangles.resize(kept);
}

}  // namespace relamp
