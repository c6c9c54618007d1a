#include "capture/mesh_mend.h"

#include "base/error.h"

namespace relamp {

namespace {

/// Normals of moved vertices whose faces turned by more than 20 degrees turn with them.
void turnNormals(const MeshMend& mend, const std::vector<Vec3>& before, Mesh& mesh) {
    constexpr float little = 0.94f;
    const std::vector<Vec3> after = vertexNormalsFromFaces(mesh);
    for (const MeshMend::MovedVertex& m : mend.moved) {
        const uint32_t v = m.vertex;
        if (v >= mesh.normals.size() || glm::dot(before[v], after[v]) > little) continue;
        const Vec3 turned = mesh.normals[v] + after[v] - before[v];
        mesh.normals[v] = glm::length(turned) > 0.1f ? glm::normalize(turned) : after[v];
    }
}

}  // namespace

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
    const size_t fileVertices = mesh.vertexCount();
    for (const Vec3& p : mend.addedPositions) {
        if (!isFinite(p)) throw Error("mesh correction: added vertex at {:g} {:g} {:g}", p.x, p.y, p.z);
        mesh.positions.push_back(p);
    }
    const std::vector<Vec3> before = mend.moved.empty() ? std::vector<Vec3>() : vertexNormalsFromFaces(mesh);
    for (const MeshMend::MovedVertex& m : mend.moved) {
        if (m.vertex >= mesh.vertexCount() || !isFinite(m.position))
            throw Error("mesh correction: vertex {} of {} at {:g} {:g} {:g}", m.vertex, mesh.vertexCount(),
                        m.position.x, m.position.y, m.position.z);
        mesh.positions[m.vertex] = m.position;
    }
    if (!mend.moved.empty()) turnNormals(mend, before, mesh);
    for (const MeshMend::TurnedVertex& t : mend.turned) {
        if (t.vertex >= fileVertices || !isFinite(t.normal) || !(glm::length(t.normal) > 0.5f))
            throw Error("mesh correction: normal {:g} {:g} {:g} of vertex {} of {}", t.normal.x, t.normal.y, t.normal.z,
                        t.vertex, fileVertices);
        if (t.vertex < mesh.normals.size()) mesh.normals[t.vertex] = glm::normalize(t.normal);
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
    if (mend.addedPositions.empty() && mend.added.empty()) return;
    Mesh patch{mend.addedPositions, {}, mend.added};
    for (const Triangle& t : patch.triangles)
        for (const uint32_t v : t)
            if (v >= patch.vertexCount())
                throw Error("mesh correction: added triangle of vertex {} of {}", v, patch.vertexCount());
    mesh.normals.resize(fileVertices, Vec3(0, 0, 1));
    for (const Vec3& n : vertexNormalsFromFaces(patch)) mesh.normals.push_back(n);
    for (const Triangle& t : patch.triangles)
        mesh.triangles.push_back(
            {uint32_t(fileVertices) + t[0], uint32_t(fileVertices) + t[1], uint32_t(fileVertices) + t[2]});
}

}  // namespace relamp
