#include "texture/photograph_geometry.h"

#include "base/parallel.h"

namespace relamp {
namespace {

constexpr uint8_t farAway = 3;  // pixels from an edge, from where on a pixel is trusted

/// What the pixels of a photograph see at their centres.
struct SeenSurface {
    std::vector<uint32_t> triangle;  ///< Hit::none where no surface is
    std::vector<float> depth;        ///< metres along the ray
    std::vector<Vec3> point;
};

SeenSurface surfaceSeen(const Camera& camera, const Scene& scene, Progress& progress) {
    const size_t width = size_t(camera.width), pixels = width * size_t(camera.height);
    SeenSurface seen{std::vector<uint32_t>(pixels, Hit::none), std::vector<float>(pixels, 0),
                     std::vector<Vec3>(pixels, Vec3(0))};
    const Vec3 origin(camera.position());
    parallelFor(
        size_t(camera.height), 8,
        [&](size_t y) {
            Ray rays[8];
            Hit hits[8];
            for (size_t x = 0; x < width; x += 8) {
                const size_t count = std::min<size_t>(8, width - x);
                for (size_t i = 0; i < count; ++i)
                    rays[i] = {origin, camera.rayDirection(Vec2(float(x + i) + 0.5f, float(y) + 0.5f)), 0, 1e30f};
                scene.cameraTracer->closest8({rays, count}, {hits, count});
                for (size_t i = 0; i < count; ++i) {
                    if (!hits[i]) continue;
                    const size_t p = y * width + x + i;
                    seen.triangle[p] = hits[i].triangle;
                    seen.depth[p] = hits[i].distance;
                    seen.point[p] = origin + hits[i].distance * rays[i].direction;
                }
            }
        },
        &progress);
    return seen;
}

/// Raises `density` to what this view shows of the vertices.
void learnDensity(const Camera& camera, const Scene& scene, const SeenSurface& seen, const PhotographGeometry& g,
                  std::vector<float>& density) {
    constexpr size_t enough = 500000;  // pixels
    const int stride = int(std::ceil(std::sqrt(double(g.away.size()) / double(enough))));
    const float focal = float(std::min(camera.focalX, camera.focalY));
    const Vec3 origin(camera.position());
    for (int y = 0; y < camera.height; y += stride)
        for (int x = 0; x < camera.width; x += stride) {
            const size_t p = size_t(y) * size_t(camera.width) + size_t(x);
            if (g.away[p] + 1 < farAway) continue;
            const Vec3 to = (seen.point[p] - origin) / seen.depth[p];
            const float cosine = std::abs(glm::dot(scene.mesh.faceNormal(seen.triangle[p]), to)),
                        here = focal / seen.depth[p] * std::sqrt(std::clamp(cosine, 0.1f, 1.0f));
            for (uint32_t v : scene.mesh.triangles[seen.triangle[p]]) density[v] = std::max(density[v], here);
        }
}

PhotographGeometry geometryOf(const View& view, const Scene& scene, const std::vector<int>& emitterOfTriangle,
                              const SeenSurface& seen) {
    const Camera& camera = view.camera;
    const int width = camera.width, height = camera.height;
    const size_t pixels = size_t(width) * size_t(height);
    PhotographGeometry g{width, height, std::vector<uint8_t>(pixels, farAway), 0, {}};
    std::vector<uint8_t>& away = g.away;
    // Distance to the nearest edge, in pixels, by the larger of the two axes.
    const float pixel = 1 / float(std::min(camera.focalX, camera.focalY));
    const auto surface = [&](size_t p) {
        return seen.triangle[p] != Hit::none && emitterOfTriangle[seen.triangle[p]] < 0;
    };
    parallelFor(size_t(height), 16, [&](size_t row) {
        const int y = int(row);
        for (int x = 0; x < width; ++x) {
            const size_t p = row * size_t(width) + size_t(x);
            if (!surface(p)) {
                away[p] = 0;
                continue;
            }
            const Vec3 normal = scene.mesh.faceNormal(seen.triangle[p]);
            const float reach = 2.5f * pixel * seen.depth[p];
            for (const auto& [dx, dy] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
                if (x + dx < 0 || y + dy < 0 || x + dx >= width || y + dy >= height) continue;
                const size_t q = size_t(y + dy) * size_t(width) + size_t(x + dx);
                if (!surface(q) || std::abs(glm::dot(seen.point[q] - seen.point[p], normal)) > reach) away[p] = 0;
            }
        }
    });
    for (uint8_t ring = 1; ring < farAway; ++ring) {
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
    for (size_t p = 0; p < pixels; ++p) {
        const int x = int(p % size_t(width)), y = int(p / size_t(width));
        const bool clipped = view.saturation > 0 && maxChannel(view.image.at(x, y)) >= view.saturation;
        if (clipped || !view.image.usableAt(x, y)) away[p] = 0;
        g.surfacePixels += away[p] > 0;
    }
    return g;
}

}  // namespace

PhotographGeometry geometryOfView(const View& view, const Scene& scene, const std::vector<int>& emitterOfTriangle,
                                  Progress& progress) {
    progress.begin("What each pixel sees", size_t(view.camera.height));
    return geometryOf(view, scene, emitterOfTriangle, surfaceSeen(view.camera, scene, progress));
}

std::vector<PhotographGeometry> photographGeometry(const Capture& capture, const Scene& scene,
                                                   const std::vector<int>& emitterOfTriangle, bool keepTriangles,
                                                   std::vector<float>& density, Progress& progress) {
    size_t rows = 0;
    for (const View& view : capture.views) rows += size_t(view.camera.height);
    progress.begin("What each pixel sees", rows);
    std::vector<PhotographGeometry> geometry;
    density.assign(scene.mesh.vertexCount(), 0);
    for (const View& view : capture.views) {
        SeenSurface seen = surfaceSeen(view.camera, scene, progress);
        geometry.push_back(geometryOf(view, scene, emitterOfTriangle, seen));
        learnDensity(view.camera, scene, seen, geometry.back(), density);
        if (keepTriangles) geometry.back().triangle = std::move(seen.triangle);
    }
    return geometry;
}

}  // namespace relamp
