#include "capture/mesh_mend.h"

#include "base/error.h"

namespace relamp {

void applyMend(const MeshMend& mend, Mesh& mesh) {
    for (const MeshMend::MovedVertex& m : mend.moved) {
        if (m.vertex >= mesh.vertexCount() || !isFinite(m.position))
            throw Error("mesh correction: vertex {} of {} at {:g} {:g} {:g}", m.vertex, mesh.vertexCount(),
                        m.position.x, m.position.y, m.position.z);
        mesh.positions[m.vertex] = m.position;
    }
    std::vector<uint8_t> removed(mesh.triangles.size(), 0);
    for (const uint32_t t : mend.removed) {
        if (t >= removed.size()) throw Error("mesh correction: triangle {} of {}", t, removed.size());
        removed[t] = 1;
    }
    size_t kept = 0;
    for (size_t t = 0; t < mesh.triangles.size(); ++t)
        if (!removed[t]) mesh.triangles[kept++] = mesh.triangles[t];
    mesh.triangles.resize(kept);
}

}  // namespace relamp
