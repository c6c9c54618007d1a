#include "scene/scene.h"

#include <algorithm>
#include <stdexcept>
#include <tuple>

#include "base/box.h"
#include "base/random.h"

namespace relamp {

Vec3 Scene::pointOf(const Hit& hit) const {
    const Triangle& t = mesh.triangles[hit.triangle];
    const float a = hit.barycentric.x, b = hit.barycentric.y;
    return (1 - a - b) * mesh.positions[t[0]] + a * mesh.positions[t[1]] + b * mesh.positions[t[2]];
}

Vec3 Scene::normalOf(const Hit& hit) const {
    const Triangle& t = mesh.triangles[hit.triangle];
    const float a = hit.barycentric.x, b = hit.barycentric.y;
    const Vec3 n = (1 - a - b) * mesh.normals[t[0]] + a * mesh.normals[t[1]] + b * mesh.normals[t[2]];
    const float length = glm::length(n);
    return length > 1e-6f ? n / length : mesh.faceNormal(hit.triangle);
}

Scene buildScene(Mesh mesh, Progress& progress, const Mat3& axes) {
    progress.begin("Scene", 3);
    Scene scene;
    scene.mesh = std::move(mesh);
    scene.axes = axes;
    const size_t n = scene.mesh.vertexCount();
    if (scene.mesh.normals.size() != n) throw std::invalid_argument("a scene's mesh has a normal for each vertex");
    scene.graph = buildVertexGraph(scene.mesh, axes);
    scene.component = connectedComponents(scene.graph, &scene.components);
    scene.material = scene.component;
    scene.materials = scene.components;
    scene.shines.assign(scene.materials, 0);
    progress.advance();
    scene.referenced.assign(n, 0);
    const glm::dmat3 own(axes);
    DBox box;  // along them
    for (const Triangle& t : scene.mesh.triangles)
        for (uint32_t v : t) {
            scene.referenced[v] = 1;
            box.grow(DVec3(scene.mesh.positions[v]) * own);
        }
    scene.diagonal = float(box.diagonal());
    // What does not round: how the mesh about each vertex is joined, three edges far.
    std::vector<uint64_t> joined(n), wider(n);
    for (uint32_t v = 0; v < n; ++v) joined[v] = mixBits(scene.graph.start[v + 1] - scene.graph.start[v]);
    for (int step = 0; step < 3; ++step) {
        for (uint32_t v = 0; v < n; ++v) {
            wider[v] = 3 * joined[v];
            for (uint32_t e = scene.graph.start[v]; e < scene.graph.start[v + 1]; ++e)
                wider[v] += mixBits(joined[scene.graph.to[e]]);
        }
        for (uint32_t v = 0; v < n; ++v) joined[v] = mixBits(wider[v]);
    }
    // And the place, rounded to a 128th of the scene only, so that other units or another origin change it hardly
    // anywhere: of 30000 vertices rounding moves a handful, where a 4096th moved a hundred and with their patterns the
    // answer by 1e-3.
    const double quantum = std::max(double(scene.diagonal) / 128, 1e-300);
    struct Place {
        uint64_t bits = 0;
        double along = 0, facing = 0;  // tell those apart that are alike otherwise, as exactly as they are written
        uint32_t vertex = 0;
        bool operator<(const Place& o) const {
            return std::tie(bits, along, facing, vertex) < std::tie(o.bits, o.along, o.facing, o.vertex);
        }
    };
    std::vector<Place> places;
    for (uint32_t v = 0; v < n; ++v) {
        if (!scene.referenced[v]) continue;
        const DVec3 p = (DVec3(scene.mesh.positions[v]) * own - box.min) / quantum,
                    normal = DVec3(scene.mesh.normals[v]) * own;
        uint64_t bits = joined[v];
        for (int k = 0; k < 3; ++k) {
            bits = mixBits(bits ^ uint64_t(std::llround(p[k])));
            bits = mixBits(bits ^ uint64_t(std::llround(16 * normal[k]) + 64));
        }
        const DVec3 slant(0.5569, 0.6831, 0.4725);
        places.push_back({bits, glm::dot(p, slant), glm::dot(normal, slant), v});
    }
    std::sort(places.begin(), places.end());
    scene.rank.assign(n, 0);
    for (size_t i = 0, first = 0; i < places.size(); ++i) {
        if (places[i].bits != places[first].bits) first = i;
        scene.rank[places[i].vertex] = uint32_t(mixBits(places[i].bits + (i - first)) >> 32);
    }
    scene.vertexSpacing.assign(n, 0);
    for (uint32_t v = 0; v < n; ++v) {
        const uint32_t begin = scene.graph.start[v], end = scene.graph.start[v + 1];
        float sum = 0;
        for (uint32_t e = begin; e < end; ++e)
            sum += glm::length(scene.mesh.positions[scene.graph.to[e]] - scene.mesh.positions[v]);
        scene.vertexSpacing[v] = end > begin ? sum / float(end - begin) : 0.0f;
    }
    progress.advance();
    scene.tracer = std::make_shared<const RayTracer>(scene.mesh, scene.diagonal);
    scene.cameraTracer = scene.mesh.shadowless.empty()
                             ? scene.tracer
                             : std::make_shared<const RayTracer>(scene.mesh, scene.diagonal, RayTracer::For::cameras);
    progress.advance();
    return scene;
}

}  // namespace relamp
