#include "capture/proxy_light.h"

#include <map>

#include "base/box.h"
#include "base/error.h"

namespace relamp {
namespace {

constexpr float farthest =
    1000;  ///< times the mesh's diagonal: beyond, an emitter has no place in single precision, and is distant light

struct UnitSphere {
    std::vector<Vec3> points{{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
    std::vector<Triangle> triangles{{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4},
                                    {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
    float scale = 1;  ///< makes the faces' area that of the sphere
    UnitSphere() {
        for (int cut = 0; cut < 2; ++cut) {
            std::map<std::pair<uint32_t, uint32_t>, uint32_t> middles;
            const auto middle = [&](uint32_t a, uint32_t b) {
                const auto [at, added] = middles.try_emplace(std::minmax(a, b), uint32_t(points.size()));
                if (added) points.push_back(glm::normalize(points[a] + points[b]));
                return at->second;
            };
            std::vector<Triangle> finer;
            for (const auto& [a, b, c] : triangles) {
                const uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
                finer.insert(finer.end(),
                             {Triangle{a, ab, ca}, Triangle{ab, b, bc}, Triangle{ca, bc, c}, Triangle{ab, bc, ca}});
            }
            triangles = std::move(finer);
        }
        double area = 0;
        for (const auto& [a, b, c] : triangles)
            area += 0.5 * double(glm::length(glm::cross(points[b] - points[a], points[c] - points[a])));
        scale = float(std::sqrt(4 * piD / area));
    }
};

}  // namespace

void addProxies(const std::vector<ProxyLight>& proxies, Mesh& mesh) {
    static const UnitSphere sphere;
    const Box box = boxOf(mesh.positions);
    const float reach = farthest * box.diagonal();
    for (const ProxyLight& proxy : proxies) {
        const Vec3 centre(proxy.centre);
        if (!isFinite(centre) || !(proxy.radius > 0 && proxy.radius < 1e12f))
            throw Error("proxy light: centre {:g} {:g} {:g}, radius {:g}: expected finite numbers and a radius above 0",
                        proxy.centre.x, proxy.centre.y, proxy.centre.z, proxy.radius);
        const float away = glm::length(centre - box.centre());
        if (!mesh.positions.empty() && !(away <= reach && proxy.radius <= reach))
            throw Error(
                "proxy light: centre {:g} {:g} {:g}, radius {:g}: expected within {:g} m of the mesh, whose middle is "
                "{:g} m away; is it in metres?",
                proxy.centre.x, proxy.centre.y, proxy.centre.z, proxy.radius, reach, away);
        // Below, single precision knows neither the sphere's shape nor the light that it gives.
        const float least = std::max(1e-5f * box.diagonal(), 1e-5f * maxChannel(glm::abs(centre)));
        if (!(proxy.radius >= least))
            throw Error("proxy light: radius {:g}: expected at least {:g} m here", proxy.radius, least);
        const uint32_t first = uint32_t(mesh.vertexCount());
        for (const Vec3& p : sphere.points) {
            mesh.positions.push_back(centre + proxy.radius * sphere.scale * p);
            mesh.normals.push_back(p);
        }
        for (const auto& [a, b, c] : sphere.triangles) mesh.triangles.push_back({first + a, first + b, first + c});
    }
}

}  // namespace relamp
