#include "texture/photograph_geometry.h"

#include "base/parallel.h"

namespace relamp {
namespace {

/// Trust of a pixel by how many pixels away the nearest edge is.
constexpr std::array<float, 4> trustAt{0.0f, 0.05f, 0.4f, 1.0f};

PhotographGeometry geometryOf(const View& view, const Scene& scene, const std::vector<int>& emitterOfTriangle,
                              Progress& progress) {
    const Camera& camera = view.camera;
    const int width = camera.width, height = camera.height;
    const size_t pixels = size_t(width) * size_t(height);
    PhotographGeometry g{width, height, std::vector<uint32_t>(pixels, Hit::none), std::vector<float>(pixels, 0), {}, 0};
    std::vector<Vec3> point(pixels, Vec3(0));
    const Vec3 origin(camera.position());
    parallelFor(
        size_t(height), 8,
        [&](size_t y) {
            for (int x = 0; x < width; ++x) {
                const size_t p = y * size_t(width) + size_t(x);
                const Vec3 d = camera.rayDirection(Vec2(float(x) + 0.5f, float(y) + 0.5f));
                const Hit hit = scene.cameraTracer->closest({origin, d, 0, 1e30f});
                if (!hit) continue;
                g.triangle[p] = hit.triangle;
                g.depth[p] = hit.distance;
                point[p] = origin + hit.distance * d;
            }
        },
        &progress);
    // Distance to the nearest edge, in pixels, by the larger of the two axes.
    const float pixel = 1 / float(std::min(camera.focalX, camera.focalY));
    std::vector<uint8_t> away(pixels, uint8_t(trustAt.size() - 1));
    const auto surface = [&](size_t p) { return g.triangle[p] != Hit::none && emitterOfTriangle[g.triangle[p]] < 0; };
    parallelFor(size_t(height), 16, [&](size_t row) {
        const int y = int(row);
        for (int x = 0; x < width; ++x) {
            const size_t p = row * size_t(width) + size_t(x);
            if (!surface(p)) {
                away[p] = 0;
                continue;
            }
            const Vec3 normal = scene.mesh.faceNormal(g.triangle[p]);
            const float reach = 2.5f * pixel * g.depth[p];
            for (const auto& [dx, dy] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
                if (x + dx < 0 || y + dy < 0 || x + dx >= width || y + dy >= height) continue;
                const size_t q = size_t(y + dy) * size_t(width) + size_t(x + dx);
                if (!surface(q) || std::abs(glm::dot(point[q] - point[p], normal)) > reach) away[p] = 0;
            }
        }
    });
    for (uint8_t ring = 1; ring + 1 < int(trustAt.size()); ++ring) {
        const std::vector<uint8_t> before = away;
        parallelFor(size_t(height), 16, [&](size_t row) {
            for (int x = 0; x < width; ++x) {
                const size_t p = row * size_t(width) + size_t(x);
                if (before[p] < ring) continue;
                for (int k = 0; k < 9; ++k) {
                    const int nx = x + k % 3 - 1, ny = int(row) + k / 3 - 1;
                    if (nx >= 0 && ny >= 0 && nx < width && ny < height &&
                        before[size_t(ny) * size_t(width) + size_t(nx)] == ring - 1)
                        away[p] = ring;
                }
            }
        });
    }
    g.trust.resize(pixels);
    for (size_t p = 0; p < pixels; ++p) {
        const int x = int(p % size_t(width)), y = int(p / size_t(width));
        const bool clipped = view.saturation > 0 && maxChannel(view.image.at(x, y)) >= view.saturation;
        g.trust[p] = clipped || !view.image.usableAt(x, y) ? 0.0f : trustAt[away[p]];
        g.surfacePixels += g.trust[p] > 0;
    }
    return g;
}

}  // namespace

std::vector<PhotographGeometry> photographGeometry(const Capture& capture, const Scene& scene,
                                                   const std::vector<int>& emitterOfTriangle, Progress& progress) {
    size_t rows = 0;
    for (const View& view : capture.views) rows += size_t(view.camera.height);
    progress.begin("What each pixel sees", rows);
    std::vector<PhotographGeometry> geometry;
    for (const View& view : capture.views) geometry.push_back(geometryOf(view, scene, emitterOfTriangle, progress));
    return geometry;
}

}  // namespace relamp
