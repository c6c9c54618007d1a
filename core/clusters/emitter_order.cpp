#include "clusters/emitter_order.h"

#include <tuple>

#include "base/box.h"
#include "base/morton.h"

namespace relamp {

std::vector<uint32_t> alongEmitter(const Mesh& mesh, const std::vector<uint32_t>& triangles, const Mat3& axes) {
    struct Place {
        uint64_t key;
        Vec3 middle;
        uint32_t triangle;
    };
    std::vector<Place> places;
    Box box;
    for (const uint32_t t : triangles) {
        const Triangle& i = mesh.triangles[t];
        places.push_back({0, (mesh.positions[i[0]] + mesh.positions[i[1]] + mesh.positions[i[2]]) / 3.0f * axes, t});
        box.grow(places.back().middle);
    }
    const float size = std::max(maxChannel(box.size()), 1e-30f);
    for (Place& p : places) p.key = mortonKey((p.middle - box.min) / size);
    std::stable_sort(places.begin(), places.end(), [](const Place& a, const Place& b) {
        return std::tie(a.key, a.middle.x, a.middle.y, a.middle.z) <
               std::tie(b.key, b.middle.x, b.middle.y, b.middle.z);
    });
    std::vector<uint32_t> order;
    order.reserve(places.size());
    for (const Place& p : places) order.push_back(p.triangle);
    return order;
}

}  // namespace relamp
