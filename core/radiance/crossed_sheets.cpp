#include "radiance/crossed_sheets.h"

#include <algorithm>

#include "base/parallel.h"
#include "base/statistics.h"

namespace relamp {
namespace {

constexpr float crossingReach = 0.03f;     ///< of the diagonal: how far sides may have gone past one another
constexpr float partedThickness = 0.001f;  ///< of the diagonal
constexpr float facing = 0.5f;             ///< cosine between two sides of a sheet
constexpr float backCosine = 0.1f;         ///< between a normal and the ray of a pixel that shows the back
constexpr size_t leastCrossed = 20;        ///< vertices
constexpr float insideOut = 0.6f;          ///< fraction of a component's vertices
constexpr float apartAtBorder = 0.5f;      ///< of an edge
constexpr int rounds = 3;                  ///< sides that are curved still touch after the first

/// Per vertex 1 where a pixel sees one of its triangles from behind.
std::vector<uint8_t> seenFromBehind(const Scene& scene, const Capture& capture, const RadianceSamples& samples) {
    const Mesh& mesh = scene.mesh;
    std::vector<std::vector<uint8_t>> ofView(capture.views.size());
    parallelFor(capture.views.size(), 1, [&](size_t i) {
        const Vec3 eye(capture.views[i].camera.position());
        ofView[i].assign(mesh.vertexCount(), 0);
        // Pixels are many: triangles are asked which way they face.
        std::vector<uint8_t> back(mesh.triangles.size());
        for (uint32_t t = 0; t < back.size(); ++t) {
            const Vec3 way = mesh.positions[mesh.triangles[t][0]] - eye;
            back[t] = glm::dot(mesh.faceNormal(t), way) > backCosine * glm::length(way);
        }
        for (const uint32_t t : samples.geometry[i].triangle)
            if (t != Hit::none && back[t])
                for (const uint32_t v : mesh.triangles[t]) ofView[i][v] = 1;
    });
    std::vector<uint8_t> seen(mesh.vertexCount(), 0);
    for (const std::vector<uint8_t>& one : ofView)
        for (size_t v = 0; v < seen.size(); ++v) seen[v] |= one[v];
    return seen;
}

/// The other side of a sheet as a vertex sees it.
struct OtherSide {
    uint32_t triangle = Hit::none;
    float gap = 0;  ///< metres that the two must move apart to touch; negative: the thickness
};

/// Sides of `mesh` about each vertex: ahead of it where they have crossed, else behind it.
std::vector<OtherSide> otherSides(const Mesh& mesh, const std::vector<Vec3>& normals, float diagonal) {
    const RayTracer tracer(mesh, diagonal);
    std::vector<OtherSide> sides(mesh.vertexCount());
    parallelFor(mesh.vertexCount(), 256, [&](size_t v) {
        const Vec3 n = normals[v];
        if (!(glm::length(n) > 0.5f)) return;
        for (const float way : {1.0f, -1.0f}) {
            const float far = (way > 0 ? crossingReach : partedThickness) * diagonal;
            const Hit hit = tracer.closest({mesh.positions[v] + way * tracer.surfaceOffset() * n, way * n, 0, far});
            if (!hit || !(glm::dot(mesh.faceNormal(hit.triangle), n) < -facing)) continue;
            sides[v] = {hit.triangle, way * (hit.distance + tracer.surfaceOffset())};
            return;
        }
    });
    return sides;
}

/// From what is seen from behind on: along the mesh, and to the other side of the sheet.
std::vector<uint8_t> crossedFrom(const Scene& scene, const std::vector<OtherSide>& sides,
                                 const std::vector<uint8_t>& seen, const std::vector<uint8_t>& leftOut) {
    std::vector<uint8_t> crossed(sides.size(), 0);
    std::vector<uint32_t> open;
    const auto take = [&](uint32_t v) {
        if (crossed[v] || leftOut[v] || !(sides[v].gap > 0)) return;
        crossed[v] = 1;
        open.push_back(v);
    };
    for (uint32_t v = 0; v < sides.size(); ++v)
        if (seen[v]) take(v);
    while (!open.empty()) {
        const uint32_t v = open.back();
        open.pop_back();
        for (uint32_t k = scene.graph.start[v]; k < scene.graph.start[v + 1]; ++k) take(scene.graph.to[k]);
        for (const uint32_t w : scene.mesh.triangles[sides[v].triangle]) take(w);
    }
    return crossed;
}

/// Takes out regions that do not begin where two sides meet: there they are apart by a part of an edge, while walls
/// that face each other over a hollow are far apart all around. Components that face themselves nearly everywhere are
/// inside out.
void keepThoseThatMeet(const Scene& scene, const std::vector<OtherSide>& sides, std::vector<uint8_t>& crossed) {
    std::vector<uint8_t> asked(crossed.size(), 0);
    std::vector<uint32_t> all(scene.components, 0), ofThem = all, region;
    for (uint32_t first = 0; first < crossed.size(); ++first) {
        ++all[scene.component[first]];
        if (!crossed[first] || asked[first]) continue;
        region.assign(1, first);
        asked[first] = 1;
        std::vector<float> apart;  // at its border, in edges
        for (size_t i = 0; i < region.size(); ++i) {
            const uint32_t v = region[i];
            bool border = false;
            for (uint32_t k = scene.graph.start[v]; k < scene.graph.start[v + 1]; ++k) {
                const uint32_t w = scene.graph.to[k];
                border |= !crossed[w];
                if (!crossed[w] || asked[w]) continue;
                asked[w] = 1;
                region.push_back(w);
            }
            if (border) apart.push_back(sides[v].gap / std::max(scene.vertexSpacing[v], 1e-20f));
        }
        if (!apart.empty() && medianOf(std::move(apart)) < apartAtBorder)
            ofThem[scene.component[first]] += uint32_t(region.size());
        else
            for (const uint32_t v : region) crossed[v] = 0;
    }
    for (size_t v = 0; v < crossed.size(); ++v) {
        const uint32_t c = scene.component[v];
        if (float(ofThem[c]) > insideOut * float(all[c])) crossed[v] = 0;
    }
}

}  // namespace

CrossedSheets crossedSheets(const Scene& scene, const Capture& capture, const RadianceSamples& samples,
                            const std::vector<uint8_t>& leftOut) {
    CrossedSheets found;
    const std::vector<uint8_t> seen = seenFromBehind(scene, capture, samples);
    if (size_t(std::count(seen.begin(), seen.end(), 1)) < leastCrossed) return found;
    Mesh mesh = scene.mesh;
    const std::vector<Vec3> normals = vertexNormalsFromFaces(mesh);
    std::vector<OtherSide> sides = otherSides(mesh, normals, scene.diagonal);
    std::vector<uint8_t> part = crossedFrom(scene, sides, seen, leftOut);
    keepThoseThatMeet(scene, sides, part);
    std::vector<float> depths;
    for (size_t v = 0; v < sides.size(); ++v)
        if (part[v]) depths.push_back(sides[v].gap);
    found.crossed = depths.size();
    if (found.crossed < leastCrossed) return found;
    found.deepest = selectQuantile(depths, 0.95);
    const float parted = partedThickness * scene.diagonal;
    for (int round = 0; round < rounds; ++round) {
        if (round > 0) {
            const std::vector<OtherSide> before = std::move(sides);
            sides = otherSides(mesh, normals, scene.diagonal);
            // What is ahead now may be another wall, over a hollow.
            for (size_t v = 0; v < sides.size(); ++v)
                if (sides[v].gap > std::max(parted, before[v].gap)) sides[v] = {};
        }
        // What lies about them, thinner than the sheet becomes, goes along.
        std::vector<uint8_t> next = part;
        for (uint32_t v = 0; v < sides.size(); ++v) {
            if (!part[v]) continue;
            for (uint32_t k = scene.graph.start[v]; k < scene.graph.start[v + 1]; ++k) {
                const uint32_t w = scene.graph.to[k];
                next[w] |= uint8_t(!leftOut[w] && sides[w].triangle != Hit::none);
            }
        }
        part = std::move(next);
        for (size_t v = 0; v < sides.size(); ++v)
            if (part[v] && sides[v].triangle != Hit::none)
                mesh.positions[v] += 0.5f * (sides[v].gap + parted) * normals[v];
    }
    for (uint32_t v = 0; v < sides.size(); ++v)
        if (mesh.positions[v] != scene.mesh.positions[v]) found.moved.push_back({v, mesh.positions[v]});
    return found;
}

}  // namespace relamp
