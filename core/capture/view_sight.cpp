#include "capture/view_sight.h"

#include <limits>

#include "base/statistics.h"
#include "capture/check_warnings.h"

namespace relamp {
namespace {

/// Distance along the view axis of the nearest surface, on a small image.
struct DepthImage {
    int width = 0, height = 0;
    float pixelsPerCell = 1;  ///< pixels of the photograph along one edge of a cell
    std::vector<float> depth;

    float at(const Vec2& pixel) const {
        const int x = int(pixel.x / pixelsPerCell), y = int(pixel.y / pixelsPerCell);
        if (x < 0 || y < 0 || x >= width || y >= height) return std::numeric_limits<float>::infinity();
        return depth[size_t(y) * width + x];
    }
};

struct Projected {
    Vec2 pixel{0};
    float depth = -1;  ///< metres; negative where the vertex does not project
};

std::vector<Projected> projectVertices(const Camera& camera, const Mesh& mesh, const Progress& progress) {
    std::vector<Projected> result(mesh.vertexCount());
    for (size_t v = 0; v < result.size(); ++v) {
        if (v % 4096 == 0) progress.check();
        if (const auto pixel = camera.project(DVec3(mesh.positions[v])))
            result[v] = {*pixel, float(camera.depthOf(DVec3(mesh.positions[v])))};
    }
    return result;
}

DepthImage rasterise(const Camera& camera, const Mesh& mesh, const std::vector<Projected>& vertices,
                     const Progress& progress) {
    constexpr int longestSide = 320;
    DepthImage image;
    image.pixelsPerCell = std::max(1.0f, float(std::max(camera.width, camera.height)) / longestSide);
    image.width = std::max(1, int(std::ceil(float(camera.width) / image.pixelsPerCell)));
    image.height = std::max(1, int(std::ceil(float(camera.height) / image.pixelsPerCell)));
    image.depth.assign(size_t(image.width) * image.height, std::numeric_limits<float>::infinity());
    for (size_t t = 0; t < mesh.triangles.size(); ++t) {
        if (t % 4096 == 0) progress.check();
        const Projected corner[3] = {vertices[mesh.triangles[t][0]], vertices[mesh.triangles[t][1]],
                                     vertices[mesh.triangles[t][2]]};
        if (corner[0].depth <= 0 || corner[1].depth <= 0 || corner[2].depth <= 0) continue;
        const Vec2 a = corner[0].pixel / image.pixelsPerCell, b = corner[1].pixel / image.pixelsPerCell,
                   c = corner[2].pixel / image.pixelsPerCell;
        const Vec2 low = glm::min(a, glm::min(b, c)), high = glm::max(a, glm::max(b, c));
        if (!(high.x >= 0 && high.y >= 0 && low.x < float(image.width) && low.y < float(image.height))) continue;
        const int x0 = int(std::max(low.x, 0.0f)), x1 = int(std::min(high.x, float(image.width - 1)));
        const int y0 = int(std::max(low.y, 0.0f)), y1 = int(std::min(high.y, float(image.height - 1)));
        const float area = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
        const auto put = [&](int x, int y, float depth) {
            float& stored = image.depth[size_t(y) * image.width + x];
            stored = std::min(stored, depth);
        };
        // Triangles smaller than a cell would slip between the centres.
        if (x1 - x0 <= 1 && y1 - y0 <= 1) {
            const Vec2 middle = (a + b + c) / 3.0f;
            if (middle.x >= 0 && middle.y >= 0 && middle.x < float(image.width) && middle.y < float(image.height))
                put(int(middle.x), int(middle.y), (corner[0].depth + corner[1].depth + corner[2].depth) / 3);
        }
        if (area == 0) continue;
        for (int y = y0; y <= y1; ++y)
            for (int x = x0; x <= x1; ++x) {
                const Vec2 p(float(x) + 0.5f, float(y) + 0.5f);
                const float wb = ((p.x - a.x) * (c.y - a.y) - (p.y - a.y) * (c.x - a.x)) / area;
                const float wc = ((b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x)) / area;
                if (wb < 0 || wc < 0 || wb + wc > 1) continue;
                put(x, y, 1 / ((1 - wb - wc) / corner[0].depth + wb / corner[1].depth + wc / corner[2].depth));
            }
    }
    return image;
}

bool isInside(const Camera& camera, const Vec2& pixel) {
    return pixel.x >= 0 && pixel.y >= 0 && pixel.x < float(camera.width) && pixel.y < float(camera.height);
}

/// What the pixels beside the mesh show: light, or a mask or black cloth. At one pixel a cell.
void judgeBackground(const View& view, const DepthImage& depth, ViewCheck& check) {
    if (view.image.pixels.empty()) return;
    constexpr float black = 0.05f;  // of the brightness of the brighter surfaces
    std::vector<float> surface;
    size_t open = 0, light = 0;
    const auto each = [&](auto&& use) {
        for (int y = 0; y < depth.height; ++y)
            for (int x = 0; x < depth.width; ++x) {
                const int px = std::min(int((float(x) + 0.5f) * depth.pixelsPerCell), view.image.width - 1),
                          py = std::min(int((float(y) + 0.5f) * depth.pixelsPerCell), view.image.height - 1);
                use(std::isfinite(depth.depth[size_t(y) * size_t(depth.width) + size_t(x)]),
                    view.image.usableAt(px, py), luminance(view.image.at(px, py)));
            }
    };
    each([&](bool mesh, bool usable, float y) {
        if (mesh && usable) surface.push_back(y);
    });
    const float least = black * nearestQuantileOf(surface, 0.9);
    each([&](bool mesh, bool usable, float y) {
        if (mesh) return;
        ++open;
        light += usable && y > least;
    });
    check.openFraction = double(open) / double(std::max<size_t>(1, depth.depth.size()));
    check.lightFraction = open ? double(light) / double(open) : 0;
}

}  // namespace

ViewSight lookAt(const View& view, const Camera& camera, const Mesh& mesh, const std::vector<uint8_t>& referenced,
                 size_t stride, ViewCheck& check, const Progress& progress) {
    const std::vector<Projected> vertices = projectVertices(camera, mesh, progress);
    const DepthImage depth = rasterise(camera, mesh, vertices, progress);
    size_t covered = 0, inside = 0;
    for (const float d : depth.depth) covered += std::isfinite(d);
    check.meshFraction = double(covered) / double(depth.depth.size());
    judgeBackground(view, depth, check);
    ViewSight sight;
    sight.state = view.state;
    sight.sees.assign(mesh.vertexCount(), 0);
    sight.brightness.assign((mesh.vertexCount() + stride - 1) / stride, std::numeric_limits<float>::quiet_NaN());
    const DVec3 eye = camera.position();
    for (size_t v = 0; v < mesh.vertexCount(); ++v) {
        const Projected& p = vertices[v];
        if (p.depth <= 0 || !isInside(camera, p.pixel)) continue;
        ++inside;
        if (!referenced[v]) continue;
        const Vec3 towardEye = Vec3(glm::normalize(eye - DVec3(mesh.positions[v])));
        // Grazing vertices are judged by their neighbours' depth, so they are left out.
        if (glm::dot(mesh.normals[v], towardEye) < 0.2f || p.depth > depth.at(p.pixel) * 1.02f) continue;
        sight.sees[v] = 1;
        if (v % stride || view.image.pixels.empty()) continue;
        const int x = std::min(int(p.pixel.x), view.image.width - 1),
                  y = std::min(int(p.pixel.y), view.image.height - 1);
        const Rgb& colour = view.image.at(x, y);
        const bool clipped = view.saturation > 0 && maxChannel(colour) >= view.saturation;
        if (view.image.usableAt(x, y) && !clipped && luminance(colour) > 0)
            sight.brightness[v / stride] = std::log2(luminance(colour));
    }
    check.verticesInside = double(inside) / double(std::max<size_t>(1, mesh.vertexCount()));
    return sight;
}

float disagreement(const std::vector<ViewSight>& sights) {
    std::vector<float> scatter;
    for (size_t s = 0; !sights.empty() && s < sights[0].brightness.size(); ++s) {
        float sum = 0, squares = 0, count = 0;
        for (const ViewSight& sight : sights)
            if (const float b = sight.brightness[s]; std::isfinite(b)) sum += b, squares += b * b, ++count;
        if (count >= 2) scatter.push_back(std::sqrt(std::max(0.0f, squares / count - sum * sum / (count * count))));
    }
    if (scatter.size() < enoughVertices) return std::numeric_limits<float>::infinity();
    return medianOf(std::move(scatter));
}

}  // namespace relamp
