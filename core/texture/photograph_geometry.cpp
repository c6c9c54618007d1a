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

/// Pixels to the nearest 0 along rows and columns (the larger of the two), farAway at most: first in the row, then
/// over the rows around.
void spreadEdges(std::vector<uint8_t>& away, int width, int height) {
    static_assert(farAway == 3);
    const size_t w = size_t(width);
    std::vector<uint8_t> inRow(away.size());
    parallelFor(size_t(height), 16, [&](size_t y) {
        const uint8_t* from = &away[y * w];
        uint8_t* to = &inRow[y * w];
        for (size_t x = 0; x < w; ++x) {
            uint8_t d = from[x] == 0 ? 0 : farAway;
            for (size_t k = 1; k < farAway; ++k)
                if ((x >= k && from[x - k] == 0) || (x + k < w && from[x + k] == 0)) d = std::min(d, uint8_t(k));
            to[x] = d;
        }
    });
    parallelFor(size_t(height), 16, [&](size_t y) {
        uint8_t* to = &away[y * w];
        std::copy_n(&inRow[y * w], w, to);
        for (size_t k = 1; k < farAway; ++k)
            for (const bool up : {true, false}) {
                if (up ? y < k : y + k >= size_t(height)) continue;
                const uint8_t* from = &inRow[(up ? y - k : y + k) * w];
                for (size_t x = 0; x < w; ++x) to[x] = std::min(to[x], std::max(from[x], uint8_t(k)));
            }
    });
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
        uint32_t triangle = Hit::none;
        Vec3 normal(0);
        for (int x = 0; x < width; ++x) {
            const size_t p = row * size_t(width) + size_t(x);
            if (!surface(p)) {
                away[p] = 0;
                continue;
            }
            const float reach = 2.5f * pixel * seen.depth[p];
            for (const auto& [dx, dy] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
                if (x + dx < 0 || y + dy < 0 || x + dx >= width || y + dy >= height) continue;
                const size_t q = size_t(y + dy) * size_t(width) + size_t(x + dx);
                if (seen.triangle[q] == seen.triangle[p]) continue;  // one plane
                if (triangle != seen.triangle[p]) {
                    triangle = seen.triangle[p];
                    normal = scene.mesh.faceNormal(triangle);
                }
                if (!surface(q) || std::abs(glm::dot(seen.point[q] - seen.point[p], normal)) > reach) away[p] = 0;
            }
        }
    });
    spreadEdges(away, width, height);
    g.surfacePixels = parallelSum(size_t(height), 16, size_t(0), [&](size_t begin, size_t end) {
        size_t count = 0;
        for (size_t p = begin * size_t(width); p < end * size_t(width); ++p) {
            const bool clipped = view.saturation > 0 && maxChannel(view.image.pixels[p]) >= view.saturation;
            if (clipped || (!view.image.usable.empty() && !view.image.usable[p])) away[p] = 0;
            count += away[p] > 0;
        }
        return count;
    });
    return g;
}

}  // namespace

void TriangleRuns::addRow(const uint32_t* triangles, size_t width) {
    if (rowStart_.empty()) rowStart_.push_back(0);
    for (size_t x = 0; x < width; ++x) {
        if (x > 0 && triangles[x] == triangles[x - 1]) continue;
        triangle_.push_back(triangles[x]);
        begin_.push_back(uint16_t(x));
    }
    rowStart_.push_back(triangle_.size());
}

void TriangleRuns::finish() {
    triangle_.shrink_to_fit();
    begin_.shrink_to_fit();
}

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
        if (!keepTriangles || view.camera.width > 65536) continue;
        TriangleRuns& runs = geometry.back().triangles;
        const size_t width = size_t(view.camera.width);
        for (size_t y = 0; y < size_t(view.camera.height); ++y) runs.addRow(&seen.triangle[y * width], width);
        runs.finish();
    }
    return geometry;
}

}  // namespace relamp
