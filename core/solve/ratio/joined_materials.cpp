#include "solve/ratio/joined_materials.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <unordered_map>

#include "base/box.h"
#include "base/random.h"
#include "scene/rim.h"

namespace relamp {
namespace {

constexpr float largerBy = 10;       // in area
constexpr float partOfRim = 0.25f;   // of the smaller surface's
constexpr size_t leastOfRim = 10;    // vertices
constexpr float rimsApart = 0.003f;  // of the diagonal, at most
constexpr float alongSide = 0.2f;    // of the larger surface's diagonal: a foot in a hole is no side

}  // namespace

std::vector<uint32_t> joinedMaterials(const Scene& scene) {
    std::vector<uint32_t> joined(scene.materials);
    for (uint32_t m = 0; m < joined.size(); ++m) joined[m] = m;
    if (scene.materials < 2) return joined;
    std::vector<double> area(scene.materials, 0);
    std::vector<Box> extent(scene.materials);
    for (size_t t = 0; t < scene.mesh.triangles.size(); ++t) {
        for (const uint32_t v : scene.mesh.triangles[t])
            extent[scene.material[v]].grow(scene.mesh.positions[v] * scene.axes);
        area[scene.material[scene.mesh.triangles[t][0]]] += double(scene.mesh.triangleArea(t));
    }
    const float cell = rimsApart * scene.diagonal;
    const auto keyOf = [&](const Vec3& p, int dx, int dy, int dz) {
        const auto at = [&](float x, int d) { return uint64_t(int64_t(std::floor(x / cell)) + d); };
        return mixBits(mixBits(mixBits(at(p.x, dx)) ^ at(p.y, dy)) ^ at(p.z, dz));
    };
    const std::vector<uint8_t> rim = rimVertices(scene.mesh);
    std::unordered_map<uint64_t, std::vector<uint32_t>> buckets;
    std::vector<size_t> ofRim(scene.materials, 0);
    for (uint32_t v = 0; v < rim.size(); ++v)
        if (rim[v]) {
            buckets[keyOf(scene.mesh.positions[v], 0, 0, 0)].push_back(v);
            ++ofRim[scene.material[v]];
        }
    struct Touch {
        size_t count = 0;  ///< vertices of the smaller's rim
        Box box;           ///< about them
    };
    std::map<std::pair<uint32_t, uint32_t>, Touch> touching;
    std::vector<uint32_t> near;
    for (uint32_t v = 0; v < rim.size(); ++v) {
        if (!rim[v]) continue;
        const uint32_t own = scene.material[v];
        near.clear();
        for (int k = 0; k < 27; ++k) {
            const auto at = buckets.find(keyOf(scene.mesh.positions[v], k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1));
            if (at == buckets.end()) continue;
            for (const uint32_t u : at->second)
                if (area[scene.material[u]] > double(largerBy) * area[own] &&
                    glm::distance(scene.mesh.positions[u], scene.mesh.positions[v]) < cell)
                    near.push_back(scene.material[u]);
        }
        std::sort(near.begin(), near.end());
        near.erase(std::unique(near.begin(), near.end()), near.end());
        for (const uint32_t other : near) {
            Touch& touch = touching[{own, other}];
            ++touch.count;
            touch.box.grow(scene.mesh.positions[v] * scene.axes);
        }
    }
    std::vector<size_t> most(scene.materials, 0);
    for (const auto& [pair, touch] : touching) {
        const auto [own, other] = pair;
        if (touch.count < leastOfRim || float(touch.count) < partOfRim * float(ofRim[own]) ||
            touch.count <= most[own] || touch.box.diagonal() < alongSide * extent[other].diagonal())
            continue;
        most[own] = touch.count;
        joined[own] = other;
    }
    return joined;
}

}  // namespace relamp
