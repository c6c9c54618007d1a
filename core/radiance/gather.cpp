#include "radiance/gather.h"

#include "base/log.h"
#include "base/parallel.h"
#include "base/statistics.h"
#include "radiance/footprint.h"

namespace relamp {
namespace {

constexpr float leastNoise = 0.003f;  ///< relative: photographs are never better known
/// Times the median radiance: brighter vertices may be emitters, which end and change where their own pixels say.
constexpr float mostAveraged = 4;

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

/// Noise of a pixel relative to its radiance, and in the dark: robust spread of second differences inside smooth
/// patches. Returns the median radiance of surfaces.
float estimateNoise(const Capture& capture, RadianceSamples& result) {
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
    if (relative.size() < 100) return 0;
    result.pixelNoise = std::clamp(1.4826f * lowerMedianOf(std::move(relative)), leastNoise, 0.28f);
    const float median = lowerMedianOf(std::move(dark));
    result.noiseFloor = std::max(median * 2e-3f, 1e-12f);
    return median;
}

/// Of each pixel the cell of the grid that it shows past the mesh; -1: it shows none.
std::vector<int> backgroundCellsOf(const View& view, const ViewGeometry& g, const DirectionGrid& grid) {
    std::vector<int> cells(size_t(g.width) * size_t(g.height), -1);
    parallelFor(size_t(g.height), 8, [&](size_t row) {
        const int y = int(row);
        if (y < 1 || y + 1 >= g.height) return;
        for (int x = 1; x + 1 < g.width; ++x)
            if (view.image.usableAt(x, y) && g.open(x, y))
                cells[row * size_t(g.width) + size_t(x)] =
                    int(grid.cellOf(view.camera.rayDirection(Vec2(x + 0.5f, y + 0.5f))));
    });
    return cells;
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
        progress.advance();
        if (environment < 0) continue;  // what is seen past the mesh of a state without distant light is none
        const std::vector<int> cellOf = backgroundCellsOf(view, g, grid);
        for (int y = 1; y + 1 < g.height; ++y)
            for (int x = 1; x + 1 < g.width; ++x) {
                const int inGrid = cellOf[size_t(y) * size_t(g.width) + size_t(x)];
                if (inGrid < 0) continue;
                const size_t cell = size_t(environment * grid.cells() + inGrid);
                result.background[cell] += view.image.at(x, y);
                ++result.backgroundPixels[cell];
                if (view.saturation > 0 && maxChannel(view.image.at(x, y)) >= view.saturation)
                    result.backgroundClipped[cell] = 1;
            }
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
    const float brightest = mostAveraged * estimateNoise(capture, result);
    const size_t n = scene.mesh.vertexCount(), views = capture.views.size();
    progress.begin("Radiance of each vertex", n);
    std::vector<Vec3> faceNormals(scene.mesh.triangles.size());
    parallelFor(faceNormals.size(), 4096, [&](size_t t) { faceNormals[t] = scene.mesh.faceNormal(t); });
    constexpr size_t block = 512;
    std::vector<std::vector<RadianceSample>> parts((n + block - 1) / block);
    std::vector<std::vector<float>> variances(parts.size());  // of samples over that of a pixel
    std::vector<uint32_t> count(n, 0);
    parallelBlocks(
        n, block,
        [&](size_t begin, size_t end) {
            std::vector<VertexLook> looks;
            for (size_t v = begin; v < end; ++v) {
                if (!scene.referenced[v]) continue;
                looks.clear();
                const float radius = scene.vertexSpacing[v];
                for (uint32_t i = 0; i < views; ++i) {
                    auto look = lookUpVertex(capture.views[i], result.geometry[i], scene, faceNormals, uint32_t(v),
                                             radius, options);
                    if (!look) continue;
                    look->sample.view = i;
                    looks.push_back(std::move(*look));
                }
                const bool bright = std::any_of(looks.begin(), looks.end(), [&](const VertexLook& look) {
                    return look.sample.clipped || maxChannel(look.sample.radiance) > brightest;
                });
                const ScaleWeights weights =
                    bright ? ScaleWeights{1} : scaleWeights(looks, result.pixelNoise, result.noiseFloor);
                for (VertexLook& look : looks) {
                    const auto [radiance, variance] = look.at(weights);
                    look.sample.radiance = radiance;
                    parts[begin / block].push_back(look.sample);
                    variances[begin / block].push_back(variance);
                }
                count[v] = uint32_t(looks.size());
            }
        },
        &progress);
    result.start.assign(n + 1, 0);
    for (size_t v = 0; v < n; ++v) result.start[v + 1] = result.start[v] + count[v];
    for (auto& part : parts) result.samples.insert(result.samples.end(), part.begin(), part.end());
    std::vector<float> variance;
    for (const auto& part : variances) variance.insert(variance.end(), part.begin(), part.end());
    if (!variance.empty())
        result.relativeNoise = std::max(leastNoise, result.pixelNoise * std::sqrt(lowerMedianOf(std::move(variance))));
    gatherBackground(capture, result, progress);
    size_t seen = 0;
    for (size_t v = 0; v < n; ++v) seen += count[v] > 0;
    logInfo("{} of {} vertices are seen, {} observations, noise {:.1f} % + {:.2g}, of a pixel {:.1f} %", seen, n,
            result.samples.size(), result.relativeNoise * 100, result.noiseFloor, result.pixelNoise * 100);
    return result;
}

}  // namespace relamp
