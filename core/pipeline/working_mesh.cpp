#include "pipeline/working_mesh.h"

#include "base/log.h"
#include "base/statistics.h"

namespace relamp {

std::optional<DecimatedMesh> workingMesh(const Capture& capture, std::optional<size_t> triangles, Progress& progress) {
    const size_t tail = capture.proxies.size() * proxyTriangles, tailVertices = capture.proxies.size() * proxyVertices;
    const size_t own = capture.mesh.triangles.size() - tail;
    const size_t wanted = triangles.value_or(own > largestWorkingMesh ? largestWorkingMesh / 2 : 0);
    if (wanted == 0 || own <= wanted) return {};
    Mesh part = capture.mesh;
    part.triangles.resize(own);
    part.positions.resize(part.positions.size() - tailVertices);
    part.normals.resize(part.positions.size());
    DecimatedMesh working = decimate(part, wanted, progress);
    logInfo("solving on {} of {} triangles", working.mesh.triangles.size(), own);
    const auto firstVertex = uint32_t(working.mesh.vertexCount()),
               firstTriangle = uint32_t(working.mesh.triangles.size());
    const auto before = uint32_t(part.positions.size());
    for (size_t v = before; v < capture.mesh.vertexCount(); ++v) {
        working.mesh.positions.push_back(capture.mesh.positions[v]);
        working.mesh.normals.push_back(capture.mesh.normals[v]);
        working.vertex.push_back(uint32_t(v));
    }
    working.places.resize(capture.mesh.vertexCount());
    for (size_t t = own; t < capture.mesh.triangles.size(); ++t) {
        Triangle moved = capture.mesh.triangles[t];
        for (size_t k = 0; k < 3; ++k) {
            Vec3 weight(0);
            weight[int(k)] = 1;
            working.places[moved[k]] = {firstTriangle + uint32_t(t - own), weight};
            moved[k] = moved[k] - before + firstVertex;
        }
        working.mesh.triangles.push_back(moved);
    }
    return working;
}

Estimate carriedBack(const Estimate& found, const DecimatedMesh& working, const Mesh& mesh) {
    Estimate result = found;
    const size_t n = mesh.vertexCount();
    const EmitterClusters& emitters = found.emitters;
    // Which emitter a vertex lies on, and what its other corners say.
    EmitterClusters& carried = result.emitters;
    carried.emitterOfVertex.assign(n, -1);
    std::vector<Vec3> weight(n, Vec3(0));  // of the corners that count for reflectance
    std::vector<uint8_t> nearest(n, 0);
    for (size_t v = 0; v < n; ++v) {
        const SurfacePlace& place = working.places[v];
        if (place.triangle == SurfacePlace::none) continue;
        const Triangle& t = working.mesh.triangles[place.triangle];
        int emitter = -2;
        Vec3 own(0);
        for (int k = 0; k < 3; ++k) {
            const int e = emitters.emitterOfVertex[t[size_t(k)]];
            if (place.weight[k] > place.weight[nearest[v]]) nearest[v] = uint8_t(k);
            if (place.weight[k] > 0.01f) emitter = emitter == -2 || emitter == e ? e : -1;
            if (e < 0) own[k] = place.weight[k];
        }
        if (emitter >= 0) carried.emitterOfVertex[v] = emitter;
        const float sum = own.x + own.y + own.z;
        weight[v] = emitter < 0 && sum > 0 ? own / sum : place.weight;
    }
    const auto between = [&](const auto& values, auto& out) {
        if (values.empty()) return;
        using Value = std::decay_t<decltype(values[0])>;
        out.assign(n, Value(0));
        for (size_t v = 0; v < n; ++v) {
            if (working.places[v].triangle == SurfacePlace::none) continue;
            const Triangle& t = working.mesh.triangles[working.places[v].triangle];
            for (int k = 0; k < 3; ++k) out[v] += weight[v][k] * values[t[size_t(k)]];
        }
    };
    Reflectance& r = result.reflectance;
    for (size_t k = 0; k < r.weight.size(); ++k) between(found.reflectance.weight[k], r.weight[k]);
    for (size_t k = 0; k < found.heldOut.size(); ++k) between(found.heldOut[k].albedo, result.heldOut[k].albedo);
    for (size_t s = 0; s < found.surfaceLight.white.size(); ++s) {
        between(found.surfaceLight.white[s], result.surfaceLight.white[s]);
        between(found.surfaceLight.coating[s], result.surfaceLight.coating[s]);
    }
    between(found.reflectance.confidence, r.confidence);
    between(found.reflectance.sigma, r.sigma);
    r.observed.assign(n, 0);
    for (size_t v = 0; v < n; ++v)
        if (working.places[v].triangle != SurfacePlace::none)
            r.observed[v] = found.reflectance.observed[working.mesh.triangles[working.places[v].triangle][nearest[v]]];
    carried.emitterOfTriangle.assign(mesh.triangles.size(), -1);
    for (EmitterCluster& e : carried.emitters) {
        e.vertices.clear();
        e.triangles.clear();
        e.level.clear();
        e.area = 0;
    }
    for (uint32_t v = 0; v < n; ++v)
        if (const int e = carried.emitterOfVertex[v]; e >= 0) {
            EmitterCluster& cluster = carried.emitters[size_t(e)];
            cluster.vertices.push_back(v);
            if (cluster.pattern) cluster.level.push_back(cluster.pattern->at(mesh.positions[v]));
            for (std::vector<Rgb>& w : r.weight) w[v] = Rgb(0);  // emitters only emit
            for (HeldOutAlbedo& held : result.heldOut) held.albedo[v] = Rgb(0);
        }
    for (uint32_t t = 0; t < mesh.triangles.size(); ++t) {
        const Triangle& c = mesh.triangles[t];
        const int e = carried.emitterOfVertex[c[0]];
        if (e < 0 || carried.emitterOfVertex[c[1]] != e || carried.emitterOfVertex[c[2]] != e) continue;
        carried.emitterOfTriangle[t] = e;
        carried.emitters[size_t(e)].triangles.push_back(t);
        carried.emitters[size_t(e)].area += mesh.triangleArea(t);
    }
    for (EmitterCluster& e : carried.emitters) rebuildPattern(mesh, e);
    carried.candidates.clear();
    if (const NearFieldCorrection& fix = found.nearFieldCorrection; !fix.empty()) {
        result.nearFieldCorrection.emitter.assign(n, -1);
        result.nearFieldCorrection.formFactor.assign(n, 0);
        for (uint32_t v = 0; v < n; ++v) {
            if (working.places[v].triangle == SurfacePlace::none) continue;
            const uint32_t from = working.mesh.triangles[working.places[v].triangle][nearest[v]];
            result.nearFieldCorrection.emitter[v] = fix.emitter[from];
            result.nearFieldCorrection.formFactor[v] = fix.formFactor[from];
        }
    }
    return result;
}

float halfAnEdge(const Scene& scene) {
    std::vector<float> lengths;
    for (uint32_t v = 0; v < scene.graph.start.size() - 1; ++v)
        for (uint32_t e = scene.graph.start[v]; e < scene.graph.start[v + 1]; ++e)
            if (scene.graph.to[e] > v)
                lengths.push_back(glm::distance(scene.mesh.positions[v], scene.mesh.positions[scene.graph.to[e]]));
    return lengths.empty() ? 0.0f : medianOf(std::move(lengths)) / 2;
}

Mesh withoutProxies(Mesh mesh, size_t proxies) {
    mesh.positions.resize(mesh.positions.size() - proxies * proxyVertices);
    mesh.normals.resize(mesh.positions.size());
    mesh.triangles.resize(mesh.triangles.size() - proxies * proxyTriangles);
    return mesh;
}

}  // namespace relamp
