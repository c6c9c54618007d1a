#include "solve/albedo/shadow_edges.h"

#include "base/statistics.h"

namespace relamp {
namespace {

constexpr int shadowReach = 3;         // mesh edges
constexpr float longestStep = 0.006f;  // of the scene's diagonal: coarser meshes tell nothing of so small errors
constexpr float flatCosine = 0.995f;   // cosine between neighbouring normals
constexpr float leftOutLight = 0.01f;  // of the median irradiance
constexpr float noIrradiance = -1.0f;  // no irradiance is negative

/// The least and the most that observed vertices within reach of one another receive, per mesh vertex.
struct Range {
    std::vector<Rgb> least, most;
};

Range rangeWithinReach(const Scene& scene, const MatteObservations& matte, const std::vector<Rgb>& irradiance) {
    Range range;
    range.least.assign(scene.mesh.vertexCount(), Rgb(noIrradiance));
    for (size_t i = 0; i < matte.vertices.size(); ++i) range.least[matte.vertices[i]] = irradiance[i];
    range.most = range.least;
    const std::vector<Vec3>&normals = scene.mesh.normals, &positions = scene.mesh.positions;
    const float longest = longestStep * scene.diagonal;
    for (int ring = 0; ring < shadowReach; ++ring) {
        Range wider = range;
        for (const uint32_t v : matte.vertices)
            for (uint32_t e = scene.graph.start[v]; e < scene.graph.start[v + 1]; ++e) {
                const uint32_t to = scene.graph.to[e];
                if (range.least[to].x < 0 || glm::dot(normals[v], normals[to]) < flatCosine ||
                    glm::distance(positions[v], positions[to]) > longest)
                    continue;
                wider.least[v] = glm::min(wider.least[v], range.least[to]);
                wider.most[v] = glm::max(wider.most[v], range.most[to]);
            }
        range = std::move(wider);
    }
    return range;
}

}  // namespace

Irradiance unsureAtShadows(const Scene& scene, const MatteObservations& matte, Irradiance irradiance) {
    if (scene.mesh.normals.size() != scene.mesh.vertexCount() || matte.vertices.empty()) return irradiance;
    const Range range = rangeWithinReach(scene, matte, irradiance.value);
    std::vector<float> brightness;
    brightness.reserve(irradiance.value.size());
    for (const Rgb& value : irradiance.value) brightness.push_back(luminance(value));
    const float floor = leftOutLight * medianOf(std::move(brightness));
    for (size_t i = 0; i < matte.vertices.size(); ++i) {
        const uint32_t v = matte.vertices[i];
        const Rgb value = irradiance.value[i], step = glm::max(range.most[v] - value, value - range.least[v]),
                  edge = 2.0f * step * step / (step + value + Rgb(1e-20f));
        Rgb& sigma = irradiance.sigma[i];
        sigma = glm::sqrt(sigma * sigma + edge * edge + Rgb(floor * floor));
    }
    return irradiance;
}

}  // namespace relamp
