#include "transport/unlit_skirts.h"

#include <algorithm>

#include "base/statistics.h"
#include "radiance/seen_background.h"
#include "scene/connected_region.h"
#include "scene/rim.h"
#include "scene/vertex_rings.h"
#include "transport/near_field.h"

namespace relamp {
namespace {

constexpr float blackAlbedo = 0.01f;       ///< no surface has less
constexpr float wellLit = 0.05f;           ///< of the median light on what photographs show
constexpr float blackBackground = 0.001f;  ///< of the median brightness of surfaces
constexpr double rimsOfBackground = 0.1;   ///< fraction of its cells that surfaces may show which the mesh lacks
constexpr int ringsToSurfaces = 3;
constexpr size_t leastUnlit = 30;  ///< vertices of a region
constexpr float sharpEnd = 0.3f;   ///< of the albedo of bright surfaces: what those beside a skirt have at least

/// Largest luminance per vertex; -1 where no photograph shows it.
std::vector<float> shownAtMost(const RadianceSamples& samples, size_t vertices) {
    std::vector<float> shown(vertices, -1);
    for (uint32_t v = 0; v < vertices; ++v)
        for (uint32_t k = samples.start[v]; k < samples.start[v + 1]; ++k)
            shown[v] = std::max(shown[v], luminance(samples.samples[k].radiance));
    return shown;
}

bool backgroundIsBlack(const RadianceSamples& samples, const std::vector<float>& shown) {
    std::vector<float> seen = seenBackground(samples), surfaces;
    for (const float y : shown)
        if (y > 0) surfaces.push_back(y);
    return !seen.empty() && !surfaces.empty() &&
           quantileOf(std::move(seen), 1 - rimsOfBackground) <= blackBackground * medianOf(std::move(surfaces));
}

/// Vertices by what a light says of them.
struct Lit {
    enum Kind : uint8_t { unknown, black, surface };
    std::vector<float> shown, light;  ///< per vertex
    std::vector<uint8_t> kind;

    /// A quantile of the albedo that surfaces among `vertices` would have under the light; 0: none is there.
    float albedoOf(const std::vector<uint32_t>& vertices, float least, double fraction) const {
        std::vector<float> ratios;
        for (const uint32_t v : vertices)
            if (kind[v] == surface && shown[v] > 0 && light[v] > least) ratios.push_back(shown[v] / light[v]);
        return ratios.empty() ? 0 : quantileOf(std::move(ratios), fraction);
    }
};

}  // namespace

std::vector<uint32_t> unlitSkirts(const Scene& scene, const RadianceSamples& samples, const EmitterClusters& clusters,
                                  const std::vector<uint8_t>& leftOut, Progress& progress) {
    const size_t n = scene.mesh.vertexCount();
    Lit all{shownAtMost(samples, n), std::vector<float>(n, 0), std::vector<uint8_t>(n, Lit::unknown)};
    const std::vector<float>& shown = all.shown;
    if (clusters.emitters.empty() || samples.states > 1 || !backgroundIsBlack(samples, shown)) return {};
    const NearField field = computeNearField(scene, clusters, {}, progress);
    std::vector<float> lit;
    for (uint32_t v = 0; v < n; ++v) {
        for (size_t e = 0; e < field.emitters; ++e)
            all.light[v] += field.at(v, e) * luminance(clusters.emitters[e].radiance);
        if (shown[v] >= 0 && all.light[v] > 0) lit.push_back(all.light[v]);
    }
    if (lit.empty()) return {};
    const float least = wellLit * medianOf(std::move(lit));
    std::vector<uint32_t> surfaces;
    for (uint32_t v = 0; v < n; ++v) {
        if (shown[v] < 0 && !leftOut[v]) continue;
        const float darkest = blackAlbedo * all.light[v], most = std::max(darkest, 3 * samples.noiseFloor);
        if (leftOut[v] || shown[v] > most) {
            all.kind[v] = Lit::surface;
            surfaces.push_back(v);
        } else if (all.light[v] > least && most < 2 * darkest) all.kind[v] = Lit::black;
    }
    const float bright = all.albedoOf(surfaces, least, 0.75);
    const std::vector<int> rings = ringsAbout(scene.graph, ringsToSurfaces, surfaces);
    const std::vector<uint8_t> rim = rimVertices(scene.mesh);
    std::vector<uint8_t> visited(n, 0), skirt(n, 0);
    for (uint32_t seed = 0; seed < n; ++seed) {
        if (visited[seed] || all.kind[seed] != Lit::black || rings[seed] >= 0) continue;
        // From black vertices to black ones, and to those that no photograph shows.
        const std::vector<uint32_t> region = connectedRegion(scene.graph, seed, visited, [&](uint32_t v) {
            return all.kind[v] == Lit::black || (shown[v] < 0 && rings[v] < 0);
        });
        size_t certain = 0, atRim = 0;
        for (const uint32_t v : region) {
            certain += all.kind[v] == Lit::black && rings[v] < 0;
            atRim += rim[v];
        }
        if (certain < leastUnlit || atRim == 0) continue;
        // A light that is directed leaves surfaces dark too, and fades towards them.
        std::vector<uint32_t> beside = region;
        ringsAbout(scene.graph, ringsToSurfaces, beside);
        if (all.albedoOf(beside, least, 0.5) < sharpEnd * bright) continue;
        for (const uint32_t v : region) skirt[v] = 1;
    }
    std::vector<uint32_t> triangles;
    for (uint32_t t = 0; t < scene.mesh.triangles.size(); ++t) {
        const Triangle& at = scene.mesh.triangles[t];
        if (skirt[at[0]] && skirt[at[1]] && skirt[at[2]]) triangles.push_back(t);
    }
    return triangles;
}

}  // namespace relamp
