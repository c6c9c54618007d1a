#include "solve/registration/places.h"

#include <algorithm>
#include <cmath>

#include "base/random.h"
#include "base/statistics.h"

namespace relamp {
namespace {

constexpr double mostPlaces = 20000;
constexpr float leastWeight = 0.3f;  ///< of an observation
constexpr float regionSide = 0.15f;  ///< of the diagonal
constexpr float sameSurface = 0.8f;  ///< least cosine between the normals of a pair

bool counts(const RadianceSample& s) { return !s.clipped && s.weight >= leastWeight; }

/// The end of a walk over `length` edges that leads away from v.
uint32_t walk(const Scene& scene, const std::vector<uint8_t>& usable, uint32_t v, int length, uint64_t random) {
    uint32_t at = v;
    for (int k = 0; k < length; ++k) {
        const uint32_t first = scene.graph.start[at], count = scene.graph.start[at + 1] - first;
        uint32_t best = at;
        float farthest = -1;
        for (uint32_t tries = 0; tries < std::min(count, 2u); ++tries) {
            random = mixBits(random);
            const uint32_t next = scene.graph.to[first + uint32_t(random % count)];
            const float distance = glm::length(scene.mesh.positions[next] - scene.mesh.positions[v]);
            if (!usable[next] || distance <= farthest) continue;
            best = next;
            farthest = distance;
        }
        at = best;
    }
    return at;
}

}  // namespace

Places choosePlaces(const Capture& capture, const Scene& scene, const RadianceSamples& samples,
                    const std::vector<uint8_t>& mirrors) {
    const Mesh& mesh = scene.mesh;
    Places places;
    std::vector<uint8_t> usable(mesh.vertexCount(), 0);
    double seen = 0;
    for (uint32_t v = 0; v < mesh.vertexCount(); ++v) {
        size_t views = 0;
        for (uint32_t k = samples.start[v]; k < samples.start[v + 1]; ++k) views += counts(samples.samples[k]);
        usable[v] = views >= 3 && (mirrors.empty() || !mirrors[v]);
        seen += usable[v];
    }
    const double fraction = mostPlaces / std::max(1.0, seen);
    constexpr uint32_t none = ~0u;
    std::vector<uint32_t> placeOf(mesh.vertexCount(), none);
    const auto placed = [&](uint32_t v) {
        if (placeOf[v] == none) {
            placeOf[v] = uint32_t(places.vertex.size());
            places.vertex.push_back(v);
        }
        return placeOf[v];
    };
    for (uint32_t v = 0; v < mesh.vertexCount(); ++v) {
        const uint64_t random = mixBits(scene.rank[v]);
        if (!usable[v] || double(unitFloat(random)) >= fraction) continue;
        const Vec3 cell = glm::floor(glm::transpose(scene.axes) * mesh.positions[v] / (regionSide * scene.diagonal));
        const bool leftOut = (int(cell.x) + int(cell.y) + int(cell.z)) & 1;
        for (const int length : {2, 5}) {
            const uint32_t end = walk(scene, usable, v, length, random ^ uint64_t(length));
            if (end != v && glm::dot(mesh.normals[end], mesh.normals[v]) > sameSurface)
                places.pairs.push_back({placed(v), placed(end), leftOut});
        }
    }
    std::vector<float> brightness;
    std::vector<std::vector<float>> depths(capture.views.size());
    for (const uint32_t v : places.vertex) {
        places.firstObservation.push_back(uint32_t(places.observations.size()));
        for (uint32_t k = samples.start[v]; k < samples.start[v + 1]; ++k) {
            const RadianceSample& s = samples.samples[k];
            if (!counts(s)) continue;
            places.observations.push_back({.view = s.view, .weight = s.weight});
            brightness.push_back(float(luminance(s.radiance)));
            depths[s.view].push_back(
                float(glm::length(DVec3(mesh.positions[v]) - capture.views[s.view].camera.position())));
        }
    }
    places.firstObservation.push_back(uint32_t(places.observations.size()));
    if (!brightness.empty()) places.dark = std::max(1e-20f, 0.02f * medianOf(std::move(brightness)));
    for (std::vector<float>& d : depths) places.depth.push_back(d.empty() ? 1.0 : double(medianOf(std::move(d))));
    return places;
}

}  // namespace relamp
