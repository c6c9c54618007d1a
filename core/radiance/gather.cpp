#include "radiance/gather.h"

#include "base/log.h"
#include "base/parallel.h"
#include "base/statistics.h"

namespace relamp {
namespace {

/// First hit of every pixel centre.
ViewGeometry traceView(const View& view, const Scene& scene, Progress& progress) {
    const Camera& camera = view.camera;
    ViewGeometry g;
    g.width = camera.width;
    g.height = camera.height;
    g.triangle.assign(size_t(g.width) * g.height, Hit::none);
    g.depth.assign(g.triangle.size(), 0);
    const Vec3 origin(camera.position());
    parallelFor(
        size_t(g.height), 8,
        [&](size_t y) {
            Ray rays[8];
            Hit hits[8];
            for (int x = 0; x < g.width; x += 8) {
                const int count = std::min(8, g.width - x);
                for (int i = 0; i < count; ++i)
                    rays[i] = {origin, camera.rayDirection(Vec2(x + i + 0.5f, y + 0.5f)), 0, 1e30f};
                scene.cameraTracer->closest8({rays, size_t(count)}, {hits, size_t(count)});
                for (int i = 0; i < count; ++i) {
                    g.triangle[y * g.width + x + i] = hits[i].triangle;
                    g.depth[y * g.width + x + i] = hits[i].distance;
                }
            }
        },
        &progress);
    return g;
}

/// One vertex in one view: bilinear over the pixels of the 2 x 2 block that see the vertex's own surface.
bool lookUp(const View& view, const ViewGeometry& g, const Scene& scene, uint32_t v, const GatherOptions& options,
            RadianceSample& out) {
    const Vec3 position = scene.mesh.positions[v], normal = scene.mesh.normals[v];
    const Vec3 eye(view.camera.position());
    const float distance = glm::length(eye - position);
    if (!(distance > 0)) return false;
    const Vec3 towardEye = (eye - position) / distance;
    const float cosine = glm::dot(normal, towardEye);
    if (cosine < options.grazingCosine) return false;
    const auto pixel = view.camera.project(DVec3(position));
    if (!pixel || pixel->x < 0.5f || pixel->y < 0.5f || pixel->x >= g.width - 0.5f || pixel->y >= g.height - 0.5f)
        return false;
    const float offset = scene.tracer->surfaceOffset();
    const Ray ray{position + normal * offset * 4.0f, towardEye, offset, distance - offset};
    if (scene.cameraTracer->occluded(ray)) return false;

    const float x = pixel->x - 0.5f, y = pixel->y - 0.5f;
    const int x0 = std::min(int(x), g.width - 2), y0 = std::min(int(y), g.height - 2);
    const float fx = x - x0, fy = y - y0;
    const float footprint =
        distance / float(std::min(view.camera.focalX, view.camera.focalY));  // metres a pixel covers
    const float reach = footprint / std::max(cosine, 0.2f);
    // Which of the 4 x 4 pixels around see the vertex's own surface: not one behind or before it, nor one past a
    // crease.
    bool own[4][4];
    for (int dy = 0; dy < 4; ++dy)
        for (int dx = 0; dx < 4; ++dx) {
            const int px = std::clamp(x0 - 1 + dx, 0, g.width - 1), py = std::clamp(y0 - 1 + dy, 0, g.height - 1);
            const size_t i = size_t(py) * g.width + px;
            own[dy][dx] = false;
            if (g.triangle[i] == Hit::none) continue;
            const Vec3 seen = eye + view.camera.rayDirection(Vec2(px + 0.5f, py + 0.5f)) * g.depth[i];
            if (std::abs(glm::dot(seen - position, normal)) > 1.5f * reach || glm::length(seen - position) > 6 * reach)
                continue;
            own[dy][dx] = glm::dot(scene.mesh.faceNormal(g.triangle[i]), normal) > 0.6f;
        }
    Rgb sum(0);
    float kept = 0, pure = 0;
    bool clipped = false;
    for (int dy = 0; dy < 2; ++dy)
        for (int dx = 0; dx < 2; ++dx) {
            const int px = x0 + dx, py = y0 + dy;
            if (!own[dy + 1][dx + 1] || !view.image.usableAt(px, py)) continue;
            // A pixel whose neighbour sees something else may be cut by the edge between them: it mixes both.
            bool whole = true;
            for (int k = 0; k < 9; ++k) whole &= own[dy + k / 3][dx + k % 3];
            const float bilinear = (dx ? fx : 1 - fx) * (dy ? fy : 1 - fy), w = bilinear * (whole ? 1.0f : 0.03f);
            const Rgb value = view.image.at(px, py);
            sum += w * value;
            kept += w;
            if (whole) pure += bilinear;
            if (view.saturation > 0 && maxChannel(value) >= view.saturation) clipped = true;
        }
    if (kept < 0.01f) return false;
    out.radiance = sum / kept;
    out.clipped = clipped;
    out.weight = std::min(1.0f, cosine * 2) * std::max(0.04f, std::min(1.0f, 1.5f * pure));
    return true;
}

/// Noise of a pixel relative to its radiance, and in the dark: robust spread of second differences inside smooth
/// patches.
void estimateNoise(const Capture& capture, RadianceSamples& result) {
    std::vector<float> relative, dark;
    for (size_t i = 0; i < capture.views.size(); ++i) {
        const Image& image = capture.views[i].image;
        const ViewGeometry& g = result.geometry[i];
        const int step = std::max(1, int(std::sqrt(double(image.width) * image.height / 20000)));
        for (int y = 1; y + 1 < image.height; y += step)
            for (int x = 1; x + 1 < image.width; x += step) {
                const size_t p = size_t(y) * image.width + x;
                if (g.triangle[p] == Hit::none) continue;
                const float a = image.at(x - 1, y).y, b = image.at(x, y).y, c = image.at(x + 1, y).y;
                const float second = std::abs(a - 2 * b + c) / 2.449f;  // white noise of variance s gives variance 6 s
                const float mean = (a + b + c) / 3;
                if (mean > 0) relative.push_back(second / mean);
                dark.push_back(mean);
            }
    }
    result.noiseFloor = 1e-12f;
    if (relative.size() < 100) return;
    // A bilinear observation averages about two pixels.
    result.relativeNoise = std::clamp(1.4826f * lowerMedianOf(std::move(relative)) * 0.7f, 0.003f, 0.2f);
    result.noiseFloor = std::max(lowerMedianOf(std::move(dark)) * 2e-3f, 1e-12f);
}

void gatherBackground(const Capture& capture, RadianceSamples& result, Progress& progress) {
    const DirectionGrid& grid = result.backgroundGrid;
    const size_t cells = size_t(grid.cells()) * result.environments();
    result.background.assign(cells, Rgb(0));
    result.backgroundPixels.assign(cells, 0);
    result.backgroundClipped.assign(cells, 0);
    progress.begin("Background", capture.views.size());
    for (size_t i = 0; i < capture.views.size(); ++i) {
        const View& view = capture.views[i];
        const ViewGeometry& g = result.geometry[i];
        const int environment = result.environmentOf(result.stateOf(uint32_t(i)));
        // What is seen past the mesh of a state without distant light is none.
        for (int y = 1; environment >= 0 && y + 1 < g.height; ++y)
            for (int x = 1; x + 1 < g.width; ++x) {
                if (!view.image.usableAt(x, y) || !g.open(x, y)) continue;
                const size_t cell = size_t(environment * grid.cells() +
                                           grid.cellOf(view.camera.rayDirection(Vec2(x + 0.5f, y + 0.5f))));
                result.background[cell] += view.image.at(x, y);
                ++result.backgroundPixels[cell];
                if (view.saturation > 0 && maxChannel(view.image.at(x, y)) >= view.saturation)
                    result.backgroundClipped[cell] = 1;
            }
        progress.advance();
    }
    for (size_t c = 0; c < result.background.size(); ++c)
        if (result.backgroundPixels[c]) result.background[c] /= float(result.backgroundPixels[c]);
}

}  // namespace

RadianceSamples gatherRadiance(const Capture& capture, const Scene& scene, const GatherOptions& options,
                               Progress& progress) {
    RadianceSamples result;
    size_t rows = 0;
    for (const View& view : capture.views) rows += size_t(view.camera.height);
    progress.begin("What each pixel sees", rows);
    for (const View& view : capture.views) result.geometry.push_back(traceView(view, scene, progress));

    if (capture.states.size() > 1) {
        result.states = uint32_t(capture.states.size());
        for (const View& view : capture.views) result.stateOfView.push_back(view.state);
        result.environmentOfState = capture.environmentOfState;
        for (uint32_t s = 0; options.ownEnvironments && s < result.states; ++s) {
            result.environmentOfState.resize(result.states);
            result.environmentOfState[s] = int(s);
        }
    }
    result.backgroundGrid.axes = scene.axes;
    const size_t n = scene.mesh.vertexCount(), views = capture.views.size();
    progress.begin("Radiance of each vertex", n);
    constexpr size_t block = 512;
    std::vector<std::vector<RadianceSample>> parts((n + block - 1) / block);
    std::vector<uint32_t> count(n, 0);
    parallelBlocks(
        n, block,
        [&](size_t begin, size_t end) {
            for (size_t v = begin; v < end; ++v) {
                if (!scene.referenced[v]) continue;
                for (uint32_t i = 0; i < views; ++i) {
                    RadianceSample s;
                    if (!lookUp(capture.views[i], result.geometry[i], scene, uint32_t(v), options, s)) continue;
                    s.view = i;
                    parts[begin / block].push_back(s);
                    ++count[v];
                }
            }
        },
        &progress);
    result.start.assign(n + 1, 0);
    for (size_t v = 0; v < n; ++v) result.start[v + 1] = result.start[v] + count[v];
    for (auto& part : parts) result.samples.insert(result.samples.end(), part.begin(), part.end());
    gatherBackground(capture, result, progress);
    estimateNoise(capture, result);
    size_t seen = 0;
    for (size_t v = 0; v < n; ++v) seen += count[v] > 0;
    logInfo("{} of {} vertices are seen, {} observations, noise {:.1f} % + {:.2g}", seen, n, result.samples.size(),
            result.relativeNoise * 100, result.noiseFloor);
    return result;
}

}  // namespace relamp
