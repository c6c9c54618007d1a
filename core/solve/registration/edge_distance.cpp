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
    const float pixel = 1 / float(std::min(view.camera.focalX, view.camera.focalY));
    // Points of two rows, as seen from the eye.
    std::vector<Vec3> row(size_t(width), Vec3(0)), next(size_t(width), Vec3(0));
    const auto takeRow = [&](int y, std::vector<Vec3>& points) {
        for (int x = 0; x < width; ++x)
            if (geometry.triangle[index(x, y)] != Hit::none)
                points[size_t(x)] =
                    view.camera.rayDirection(Vec2(float(x) + 0.5f, float(y) + 0.5f)) * geometry.depth[index(x, y)];
    };
    if (height > 0) takeRow(0, next);
    for (int y = 0; y < height; ++y) {
        row.swap(next);
        if (y + 1 < height) takeRow(y + 1, next);
        for (int x = 0; x < width; ++x) {
            const size_t here = index(x, y);
            if (geometry.triangle[here] == Hit::none || x == 0 || y == 0 || x + 1 == width || y + 1 == height) {
                distance[here] = 0;
                continue;
            }
            const Vec3 normal = scene.mesh.faceNormal(geometry.triangle[here]);
            const auto beside = [&](size_t there, const Vec3& point) {
                const float off = std::abs(glm::dot(point - row[size_t(x)], normal));
                if (geometry.triangle[there] == Hit::none ||
                    off > apart * pixel * std::max(geometry.depth[here], geometry.depth[there]))
                    distance[here] = distance[there] = 0;
            };
            beside(index(x + 1, y), row[size_t(x + 1)]);
            beside(index(x, y + 1), next[size_t(x)]);
        }
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
