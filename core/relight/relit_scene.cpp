#include "relight/relit_scene.h"

#include <map>

#include "base/error.h"
#include "image/environment_map.h"

namespace relamp {
namespace {

Mesh shapeMesh(const AddedEmitter& added) {
    Mesh m;
    const auto point = [&](const Vec3& p, const Vec3& n) {
        m.positions.push_back(Vec3(added.matrix * Vec4(p, 1)));
        m.normals.push_back(glm::normalize(glm::transpose(glm::inverse(Mat3(added.matrix))) * n));
    };
    const bool mirrored = glm::determinant(Mat3(added.matrix)) < 0;
    const auto face = [&](uint32_t a, uint32_t b, uint32_t c) { m.triangles.push_back(mirrored ? Triangle{a, c, b} : Triangle{a, b, c}); };
    const float w = added.size.x / 2, h = added.size.y / 2;
    if (added.shape == AddedEmitter::Shape::rectangle) {
        for (const Vec2& c : {Vec2(-1, -1), Vec2(-1, 1), Vec2(1, 1), Vec2(1, -1)}) point(Vec3(c.x * w, c.y * h, 0), Vec3(0, 0, -1));
        face(0, 1, 2);
        face(0, 2, 3);
    } else if (added.shape == AddedEmitter::Shape::disk) {
        constexpr uint32_t around = 32;
        // Corners a little outside the circle, so that the polygon has the disc's area.
        const float grow = std::sqrt((2 * pi / around) / std::sin(2 * pi / around));
        point(Vec3(0), Vec3(0, 0, -1));
        for (uint32_t i = 0; i < around; ++i) point(grow * Vec3(w * std::cos(2 * pi * float(i) / around), h * std::sin(2 * pi * float(i) / around), 0), Vec3(0, 0, -1));
        for (uint32_t i = 0; i < around; ++i) face(0, 1 + (i + 1) % around, 1 + i);
    } else {
        constexpr uint32_t rings = 12, around = 24;
        constexpr float grow = 1.00718f;  // so that the polyhedron has the sphere's area
        for (uint32_t r = 0; r <= rings; ++r)
            for (uint32_t i = 0; i < around; ++i) {
                const float t = pi * float(r) / rings, p = 2 * pi * float(i) / around;
                const Vec3 n(std::sin(t) * std::cos(p), std::sin(t) * std::sin(p), std::cos(t));
                point(grow * Vec3(n.x * w, n.y * h, n.z * w), n);
            }
        for (uint32_t r = 0; r < rings; ++r)
            for (uint32_t i = 0; i < around; ++i) {
                const uint32_t a = r * around + i, b = r * around + (i + 1) % around;
                if (r > 0) face(a, a + around, b);
                if (r + 1 < rings) face(b, a + around, b + around);
            }
    }
    return m;
}

/// Moves triangles. A vertex whose triangles move differently is doubled, so that nothing is stretched; one that stays keeps its number.
void moveTriangles(const Scene& scene, const std::vector<Mat4>& movements, const std::vector<uint32_t>& ofPiece, const std::vector<uint32_t>& ofEmitter,
                   const std::vector<int>& emitterOfTriangle, Mesh& mesh, std::vector<std::vector<Rgb>>& weight) {
    constexpr uint32_t none = ~0u;
    std::vector<uint32_t> movement(mesh.triangles.size(), 0), owner(scene.mesh.vertexCount(), none);
    for (size_t t = 0; t < movement.size(); ++t) {
        const int e = emitterOfTriangle[t];
        movement[t] = e >= 0 ? ofEmitter[size_t(e)] : ofPiece[scene.piece[scene.mesh.triangles[t][0]]];
        if (!movement[t])
            for (uint32_t v : scene.mesh.triangles[t]) owner[v] = 0;
    }
    std::map<std::pair<uint32_t, uint32_t>, uint32_t> copyOf;
    for (size_t t = 0; t < movement.size(); ++t) {
        const uint32_t m = movement[t];
        if (!m) continue;
        const Mat4& matrix = movements[m];
        for (uint32_t& v : mesh.triangles[t]) {
            const auto [place, isNew] = copyOf.emplace(std::pair(v, m), v);
            if (isNew) {
                if (owner[v] == none) {
                    owner[v] = m;
                } else {
                    place->second = uint32_t(mesh.positions.size());
                    mesh.positions.push_back(scene.mesh.positions[v]);
                    mesh.normals.push_back(scene.mesh.normals[v]);
                    for (auto& lobe : weight) lobe.push_back(lobe[v]);
                }
                Vec3& normal = mesh.normals[place->second];
                mesh.positions[place->second] = Vec3(matrix * Vec4(scene.mesh.positions[v], 1));
                normal = glm::transpose(glm::inverse(Mat3(matrix))) * scene.mesh.normals[v];
                if (const float length = glm::length(normal); length > 0) normal /= length;
            }
            v = place->second;
        }
        if (glm::determinant(Mat3(matrix)) < 0) std::swap(mesh.triangles[t][1], mesh.triangles[t][2]);
    }
}

DirectionGrid gridFor(const Image& map) {
    DirectionGrid grid{64};
    while (grid.side < 512 && grid.side * 2 <= map.width) grid.side *= 2;
    return grid;
}

std::shared_ptr<const DistantLight> distantLight(const Estimate& estimate, const EnvironmentLook& look) {
    DirectionGrid grid{estimate.environmentSide};
    std::vector<Rgb> cells;
    if (look.source == EnvironmentLook::Source::none) {
        cells.assign(size_t(grid.cells()), Rgb(0));
    } else if (look.source == EnvironmentLook::Source::file) {
        Image map = readEnvironment(look.file);
        if (look.yawDegrees != 0) map = yawed(map, look.yawDegrees);
        grid = gridFor(map);
        cells = integrateOverCells(map, grid);
    } else {
        cells = estimate.environment;
        if (look.yawDegrees != 0) cells = integrateOverCells(yawed(latLongFromCells(cells, grid, 1024), look.yawDegrees), grid);
    }
    const Rgb gain = look.tint * std::exp2(look.exposureStops);
    for (Rgb& c : cells) c *= gain;
    return std::make_shared<const DistantLight>(grid, std::move(cells));
}

}  // namespace

RelitScene applyLook(const Scene& scene, const Estimate& estimate, const Look& look, Progress& progress) {
    RelitScene out;
    out.basis = estimate.reflectance.basis;
    out.weight = estimate.reflectance.weight;
    const std::vector<EmitterCluster>& clusters = estimate.emitters.emitters;
    std::vector<Mat4> matrix(clusters.size(), Mat4(1));
    std::vector<Rgb> radiance = estimate.lighting.emitterRadiance;
    for (const EmitterLook& e : look.emitters) {
        size_t at = clusters.size();
        for (size_t i = 0; i < clusters.size(); ++i)
            if (clusters[i].id == e.id) at = i;
        if (at == clusters.size()) throw Error("emitters: there is no emitter named {}", e.id);
        matrix[at] = e.matrix;
        radiance[at] = e.enabled ? radiance[at] * e.powerScale : Rgb(0);
    }
    // Which movement each triangle takes: its emitter's own, else that of the parts on its piece of the mesh. 0: it stays.
    std::vector<Mat4> movements{Mat4(1)};
    std::vector<uint32_t> movementOfPiece(scene.pieces, 0), movementOfEmitter(clusters.size(), 0);
    for (const PartLook& part : look.parts) {
        if (part.seedVertex >= scene.mesh.vertexCount()) throw Error("parts: seed_vertex {} does not exist, the mesh has {} vertices", part.seedVertex, scene.mesh.vertexCount());
        if (part.matrix == Mat4(1)) continue;
        uint32_t& movement = movementOfPiece[scene.piece[part.seedVertex]];
        if (!movement) {
            movement = uint32_t(movements.size());
            movements.push_back(Mat4(1));
        }
        movements[movement] = part.matrix * movements[movement];
    }
    out.emitterOfTriangle = estimate.emitters.emitterOfTriangle;
    for (size_t e = 0; e < clusters.size(); ++e) {
        RelitEmitter emitter;
        emitter.id = clusters[e].id;
        emitter.radiance = radiance[e];
        emitter.surface = emitterSurface(scene.mesh, clusters[e], matrix[e]);
        out.emitters.push_back(std::move(emitter));
        if (matrix[e] == Mat4(1)) continue;
        movementOfEmitter[e] = uint32_t(movements.size());
        movements.push_back(matrix[e]);
    }
    Mesh mesh = scene.mesh;
    bool moved = movements.size() > 1;
    if (moved) moveTriangles(scene, movements, movementOfPiece, movementOfEmitter, out.emitterOfTriangle, mesh, out.weight);
    for (const AddedEmitter& added : look.added) {
        const Mesh shape = shapeMesh(added);
        const uint32_t first = uint32_t(mesh.positions.size());
        EmitterCluster cluster;
        for (const Triangle& t : shape.triangles) {
            cluster.triangles.push_back(uint32_t(mesh.triangles.size()));
            mesh.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
            out.emitterOfTriangle.push_back(int(out.emitters.size()));
        }
        mesh.positions.insert(mesh.positions.end(), shape.positions.begin(), shape.positions.end());
        mesh.normals.insert(mesh.normals.end(), shape.normals.begin(), shape.normals.end());
        for (auto& lobe : out.weight) lobe.resize(mesh.positions.size(), Rgb(0));
        RelitEmitter emitter;
        emitter.id = added.id;
        emitter.radiance = added.radiance;
        emitter.surface = emitterSurface(mesh, cluster);
        out.emitters.push_back(std::move(emitter));
        moved = true;
    }
    if (look.neutralMaterials)
        for (auto& lobe : out.weight)
            for (Rgb& w : lobe) w = Rgb(luminance(w));
    out.scene = moved ? buildScene(std::move(mesh), progress) : scene;
    out.distant = distantLight(estimate, look.environment);
    return out;
}

}  // namespace relamp
