#include "clusters/false_lamps.h"

#include <algorithm>
#include <set>

namespace relamp {
namespace {

constexpr float sameRadiance = 0.03f;

bool alike(const Rgb& a, const Rgb& b) { return maxChannel(glm::abs(a - b)) <= sameRadiance * std::max(maxChannel(a), maxChannel(b)); }

/// At most `most` of the vertices, in an order that does not know the file's.
std::vector<uint32_t> someOf(const Scene& scene, std::vector<uint32_t> vertices, size_t most) {
    std::sort(vertices.begin(), vertices.end(), [&](uint32_t a, uint32_t b) { return scene.rank[a] < scene.rank[b]; });
    if (vertices.size() > most) vertices.resize(most);
    return vertices;
}

float gapBetween(const Scene& scene, const EmitterCluster& a, const EmitterCluster& b) {
    constexpr size_t most = 512;
    float least = 1e30f;
    const std::vector<uint32_t> others = someOf(scene, b.vertices, most);
    for (uint32_t v : someOf(scene, a.vertices, most))
        for (uint32_t u : others) {
            const Vec3 d = scene.mesh.positions[v] - scene.mesh.positions[u];
            least = std::min(least, glm::dot(d, d));
        }
    return std::sqrt(least);
}

/// `b` becomes part of `a`.
void join(const EmitterCluster& b, EmitterCluster& a) {
    const float whole = std::max(a.area + b.area, 1e-20f);
    a.centroid = (a.area * a.centroid + b.area * b.centroid) / whole;
    const Vec3 normal = a.area * a.normal + b.area * b.normal;
    a.normal = glm::length(normal) > 0.2f * whole ? glm::normalize(normal) : Vec3(0);
    a.area = whole;
    a.vertices.insert(a.vertices.end(), b.vertices.begin(), b.vertices.end());
    a.triangles.insert(a.triangles.end(), b.triangles.begin(), b.triangles.end());
    for (std::vector<uint32_t>* list : {&a.vertices, &a.triangles}) {
        std::sort(list->begin(), list->end());
        list->erase(std::unique(list->begin(), list->end()), list->end());
    }
    a.twoSided |= b.twoSided;
    a.evidence.viewsSeen = std::max(a.evidence.viewsSeen, b.evidence.viewsSeen);
    a.evidence.samples += b.evidence.samples;
}

}  // namespace

void joinSplitLamps(const Scene& scene, std::vector<EmitterCluster>& lamps) {
    constexpr float hair = 0.006f;
    std::stable_sort(lamps.begin(), lamps.end(), [](const EmitterCluster& a, const EmitterCluster& b) { return emitterPower(a) > emitterPower(b); });
    for (size_t i = 0; i < lamps.size(); ++i)
        for (size_t k = i + 1; k < lamps.size();) {
            const bool one = !lamps[i].unseen && !lamps[k].unseen && alike(lamps[i].radiance, lamps[k].radiance) && gapBetween(scene, lamps[i], lamps[k]) < hair * scene.diagonal;
            if (!one) {
                ++k;
                continue;
            }
            join(lamps[k], lamps[i]);
            lamps.erase(lamps.begin() + ptrdiff_t(k));
            k = i + 1;  // what is larger now may reach others
        }
}

bool showsLampPastEdge(const Scene& scene, const Capture& capture, const RadianceSamples& samples, const EmitterCluster& lamp, const EmitterCluster& patch) {
    constexpr int reach = 8;
    if (lamp.unseen || patch.unseen || !alike(lamp.radiance, patch.radiance) || patch.area > 0.25f * lamp.area) return false;
    const std::set<uint32_t> triangles(lamp.triangles.begin(), lamp.triangles.end());
    size_t bright = 0, beside = 0;
    for (uint32_t v : patch.vertices)
        for (uint32_t s = samples.start[v]; s < samples.start[v + 1]; ++s) {
            const RadianceSample& r = samples.samples[s];
            if (!alike(r.radiance, patch.radiance)) continue;
            const auto pixel = capture.views[r.view].camera.project(DVec3(scene.mesh.positions[v]));
            if (!pixel) continue;
            ++bright;
            const ViewGeometry& g = samples.geometry[r.view];
            bool near = false;
            for (int y = std::max(0, int(pixel->y) - reach); y <= std::min(g.height - 1, int(pixel->y) + reach) && !near; ++y)
                for (int x = std::max(0, int(pixel->x) - reach); x <= std::min(g.width - 1, int(pixel->x) + reach) && !near; ++x)
                    near = triangles.count(g.triangle[size_t(y) * size_t(g.width) + size_t(x)]) > 0;
            beside += near;
        }
    return bright > 0 && double(beside) > 0.9 * double(bright);
}

float albedoBesideLamps(const Scene& scene, const std::vector<EmitterCluster>& lamps, const EmitterCluster& patch) {
    constexpr size_t mostVertices = 64;
    constexpr float slack = 0.35f;  // in the cosine: what a normal that is 20 degrees off makes of a grazing one
    std::vector<float> demanded;
    for (uint32_t v : someOf(scene, patch.vertices, mostVertices)) {
        Rgb lit(0);
        for (const EmitterCluster& lamp : lamps) {
            if (lamp.unseen || &lamp == &patch || maxChannel(lamp.radiance) < 1.3f * maxChannel(patch.radiance)) continue;
            float factor = 0;
            for (const uint32_t t : lamp.triangles) {
                const Triangle& corners = scene.mesh.triangles[t];
                const Vec3 to = (scene.mesh.positions[corners[0]] + scene.mesh.positions[corners[1]] + scene.mesh.positions[corners[2]]) / 3.0f - scene.mesh.positions[v];
                const float area = scene.mesh.triangleArea(t), squared = std::max(glm::dot(to, to), area), distance = std::sqrt(squared);
                const float at = std::min(1.0f, glm::dot(to, scene.mesh.normals[v]) / distance + slack), from = std::abs(glm::dot(to, scene.mesh.faceNormal(t))) / distance;
                factor += area * std::max(0.0f, at) * from / (pi * squared);  // its hidden side, which no photograph shows, shines as well
            }
            lit += lamp.radiance * std::min(factor, 1.0f);
        }
        float worst = 0;
        for (int c = 0; c < 3; ++c)
            if (patch.radiance[c] > 0.2f * maxChannel(patch.radiance)) worst = std::max(worst, patch.radiance[c] / std::max(lit[c], 1e-20f));
        demanded.push_back(worst);
    }
    if (demanded.empty()) return 1e30f;
    const auto middle = demanded.begin() + ptrdiff_t(demanded.size() / 2);
    std::nth_element(demanded.begin(), middle, demanded.end());
    return *middle;
}

}  // namespace relamp
