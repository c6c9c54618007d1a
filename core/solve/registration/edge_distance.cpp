#include "solve/registration/edge_distance.h"

#include <algorithm>
#include <cmath>

namespace relamp {
namespace {

constexpr float apart = 2;  ///< pixels off its neighbour's plane that make a pixel another surface's

}  // namespace

std::vector<uint8_t> edgeDistance(const View& view, const ViewGeometry& geometry, const Scene& scene) {
    const int width = geometry.width, height = geometry.height;
    const auto index = [&](int x, int y) { return size_t(y) * size_t(width) + size_t(x); };
    std::vector<uint8_t> distance(size_t(width) * size_t(height), 255);
    const Vec3 eye(view.camera.position());
    const float pixel = 1 / float(std::min(view.camera.focalX, view.camera.focalY));
    const auto rayOf = [&](int x, int y) { return view.camera.rayDirection(Vec2(float(x) + 0.5f, float(y) + 0.5f)); };
    // Where the neighbour's ray meets the pixel's plane against where it meets a surface.
    const auto otherSurface = [&](int x, int y, int nx, int ny) {
        const size_t a = index(x, y), b = index(nx, ny);
        if (geometry.triangle[b] == Hit::none) return true;
        const Vec3 normal = scene.mesh.faceNormal(geometry.triangle[a]);
        const Vec3 between = rayOf(nx, ny) * geometry.depth[b] - rayOf(x, y) * geometry.depth[a];
        return std::abs(glm::dot(between, normal)) > apart * pixel * std::max(geometry.depth[a], geometry.depth[b]);
    };
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const size_t a = index(x, y);
            if (geometry.triangle[a] == Hit::none || x == 0 || y == 0 || x + 1 == width || y + 1 == height) {
                distance[a] = 0;
                continue;
            }
            for (const auto& [nx, ny] : {std::pair{x + 1, y}, std::pair{x, y + 1}})
                if (otherSurface(x, y, nx, ny)) distance[a] = distance[index(nx, ny)] = 0;
        }
    const auto from = [&](uint8_t& d, uint8_t neighbour) {
        d = std::min<uint8_t>(d, neighbour == 255 ? 255 : neighbour + 1);
    };
    for (int y = 1; y + 1 < height; ++y)
        for (int x = 1; x + 1 < width; ++x)
            for (int k = 0; k < 4; ++k) from(distance[index(x, y)], distance[index(x - 1 + k % 3, y - 1 + k / 3)]);
    for (int y = height - 2; y > 0; --y)
        for (int x = width - 2; x > 0; --x)
            for (int k = 5; k < 9; ++k) from(distance[index(x, y)], distance[index(x - 1 + k % 3, y - 1 + k / 3)]);
    return distance;
}

}  // namespace relamp
