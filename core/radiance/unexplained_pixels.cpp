#include "radiance/unexplained_pixels.h"

#include <array>
#include <cmath>
#include <limits>

#include "base/parallel.h"
#include "base/statistics.h"
#include "radiance/seen_past.h"

namespace relamp {
namespace {

constexpr double mostCellsOfAll = 5e6;     ///< of all views
constexpr size_t mostOthers = 8;           ///< views that one is compared with
constexpr size_t fewestOthers = 2;         ///< that must see a place
constexpr int besideLight = 3;             ///< cells from a light: its blur
constexpr float sameDepth = 0.02f;         ///< relative, of a place that another view sees
constexpr float leastSpread = 0.06f;       ///< of log radiance: what views of a matte surface differ by
constexpr float loose = 1.1f;              ///< times the spread
constexpr float againstIt = -2.5f;         ///< least gain of a cell
constexpr float beforeBackground = -0.9f;  ///< least gain there: other views may show the part itself before it
constexpr int leastBeside = 4;             ///< of the 24 about a cell that differ as it does: of a line
constexpr float ofASpeck = -1.5f;          ///< gain of one without

int stepFor(const Capture& capture) {
    double pixels = 0;
    for (const View& view : capture.views) pixels += double(view.camera.width) * double(view.camera.height);
    return std::max(1, int(std::ceil(std::sqrt(pixels / mostCellsOfAll))));
}

/// Marks the cells of lights and those beside them as not usable.
void leaveLightsOut(const Scene& scene, const ViewGeometry& seen, const std::vector<uint8_t>& isLight,
                    const UnexplainedView& view, std::vector<uint8_t>& usable) {
    std::vector<uint8_t> light(usable.size(), 0);
    for (int y = 0; y < view.height * view.step; ++y)
        for (int x = 0; x < view.width * view.step; ++x) {
            const uint32_t t = seen.triangle[size_t(y) * size_t(seen.width) + size_t(x)];
            if (t == Hit::none) continue;
            const Triangle& c = scene.mesh.triangles[t];
            if (isLight[c[0]] || isLight[c[1]] || isLight[c[2]])
                light[size_t(y / view.step) * size_t(view.width) + size_t(x / view.step)] = 1;
        }
    for (int y = 0; y < view.height; ++y)
        for (int x = 0; x < view.width; ++x) {
            if (!light[size_t(y) * size_t(view.width) + size_t(x)]) continue;
            for (int ny = std::max(0, y - besideLight); ny <= std::min(view.height - 1, y + besideLight); ++ny)
                for (int nx = std::max(0, x - besideLight); nx <= std::min(view.width - 1, x + besideLight); ++nx)
                    usable[size_t(ny) * size_t(view.width) + size_t(nx)] = 0;
        }
}

/// Fills `shown` and `depth`; returns 1 for each cell that is mostly of usable pixels.
std::vector<uint8_t> cellsOf(const View& view, const ViewGeometry& seen, float floor, UnexplainedView& out) {
    const size_t count = size_t(out.width) * size_t(out.height);
    out.shown.assign(count, Rgb(0));
    std::vector<uint8_t> usable(count, 0);
    out.depth.assign(count, std::numeric_limits<float>::infinity());
    for (int y = 0; y < out.height; ++y)
        for (int x = 0; x < out.width; ++x) {
            const size_t cell = size_t(y) * size_t(out.width) + size_t(x);
            Rgb sum(0);
            int pixels = 0;
            for (int k = 0; k < out.step * out.step; ++k) {
                const int px = x * out.step + k % out.step, py = y * out.step + k / out.step;
                if (!view.image.usableAt(px, py)) continue;
                if (view.saturation > 0 && maxChannel(view.image.at(px, py)) >= view.saturation) continue;
                sum += view.image.at(px, py);
                ++pixels;
            }
            usable[cell] = 2 * pixels > out.step * out.step;
            const Rgb mean = sum / float(std::max(1, pixels));
            for (int c = 0; c < 3; ++c) out.shown[cell][c] = std::log(std::max(mean[c], floor));
            const size_t middle =
                size_t(y * out.step + out.step / 2) * size_t(seen.width) + size_t(x * out.step + out.step / 2);
            if (seen.triangle[middle] != Hit::none) out.depth[cell] = seen.depth[middle];
        }
    return usable;
}

/// Other views of the same state, evenly spread.
std::vector<size_t> othersOf(const Capture& capture, size_t view) {
    std::vector<size_t> same;
    for (size_t j = 0; j < capture.views.size(); ++j)
        if (j != view && capture.views[j].state == capture.views[view].state) same.push_back(j);
    if (same.size() <= mostOthers) return same;
    std::vector<size_t> some;
    for (size_t k = 0; k < mostOthers; ++k) some.push_back(same[k * same.size() / mostOthers]);
    return some;
}

float gainOf(float distance, float spread) {
    const float s = loose * std::max(spread, leastSpread);
    return std::clamp(0.5f * distance * distance / (s * s) + std::log(s), againstIt, UnexplainedView::mostGain);
}

/// Single cells that differ are noise: what is not beside others that differ is as the surface there.
void dropSpecks(UnexplainedView& view) {
    const auto isUnexplained = [&](int x, int y) {
        return x >= 0 && y >= 0 && x < view.width && y < view.height &&
               view.gain[size_t(y) * size_t(view.width) + size_t(x)] > 0;
    };
    std::vector<uint8_t> kept(view.gain.size(), 0);
    parallelFor(size_t(view.height), 16, [&](size_t y) {
        for (int x = 0; x < view.width; ++x) {
            int beside = 0;
            for (int k = 0; k < 25; ++k) beside += k != 12 && isUnexplained(x + k % 5 - 2, int(y) + k / 5 - 2);
            kept[y * size_t(view.width) + size_t(x)] = beside >= leastBeside;
        }
    });
    for (size_t cell = 0; cell < kept.size(); ++cell)
        if (view.known[cell] && !kept[cell])
            view.gain[cell] = std::min(view.gain[cell], std::isinf(view.depth[cell]) ? beforeBackground : ofASpeck);
}

}  // namespace

std::vector<UnexplainedView> unexplainedPixels(const Scene& scene, const Capture& capture,
                                               const RadianceSamples& samples, const std::vector<uint8_t>& isLight,
                                               Progress& progress) {
    const size_t count = capture.views.size();
    std::vector<UnexplainedView> views(count);
    std::vector<std::vector<uint8_t>> usable(count);
    const SeenPast past(scene, capture, samples);
    const int step = stepFor(capture);
    size_t rows = 0;
    for (const View& view : capture.views) rows += size_t(view.camera.height / step);
    progress.begin("What the mesh lacks", rows);
    parallelFor(count, 1, [&](size_t i) {
        UnexplainedView& view = views[i];
        view.step = step;
        view.width = capture.views[i].camera.width / step;
        view.height = capture.views[i].camera.height / step;
        usable[i] = cellsOf(capture.views[i], samples.geometry[i], past.floor(), view);
        leaveLightsOut(scene, samples.geometry[i], isLight, view, usable[i]);
    });
    for (size_t i = 0; i < count; ++i) {
        UnexplainedView& view = views[i];
        const Camera& camera = capture.views[i].camera;
        const std::vector<size_t> others = othersOf(capture, i);
        view.gain.assign(view.depth.size(), 0);
        view.known.assign(view.depth.size(), 0);
        const auto rowOf = [&](size_t y) {
            std::array<std::vector<float>, 3> shown;
            for (int x = 0; x < view.width; ++x) {
                const size_t cell = y * size_t(view.width) + size_t(x);
                if (!usable[i][cell]) continue;
                const Vec3 direction = camera.rayDirection(float(step) * Vec2(float(x) + 0.5f, float(y) + 0.5f));
                const Rgb& own = view.shown[cell];
                if (std::isinf(view.depth[cell])) {
                    const auto off = past.difference(i, direction, 0, glm::exp(own));
                    if (!off) continue;
                    view.known[cell] = 1;
                    view.gain[cell] = std::max(gainOf(*off, samples.pixelNoise), beforeBackground);
                    continue;
                }
                const DVec3 place = camera.position() + double(view.depth[cell]) * DVec3(direction);
                for (auto& channel : shown) channel.clear();
                for (const size_t j : others) {
                    const UnexplainedView& other = views[j];
                    const std::optional<Vec2> at = capture.views[j].camera.project(place);
                    const std::optional<size_t> there = at ? other.cellAt(*at) : std::nullopt;
                    if (!there || !usable[j][*there]) continue;
                    const float distance = float(glm::length(place - capture.views[j].camera.position()));
                    if (!(std::abs(other.depth[*there] - distance) < sameDepth * distance)) continue;
                    for (int c = 0; c < 3; ++c) shown[size_t(c)].push_back(other.shown[*there][c]);
                }
                if (shown[0].size() < fewestOthers) continue;
                float off = 0, apart = 0;
                for (int c = 0; c < 3; ++c) {
                    std::vector<float>& values = shown[size_t(c)];
                    const float middle = meanMedianOf(values);
                    off += std::abs(own[c] - middle) / 3;
                    for (float& value : values) value = std::abs(value - middle);
                    apart += 1.4826f * meanMedianOf(values) / 3;
                }
                view.known[cell] = 1;
                view.gain[cell] = gainOf(off, std::max(apart, samples.pixelNoise));
            }
        };
        parallelFor(size_t(view.height), 4, rowOf, &progress);
        dropSpecks(view);
    }
    return views;
}

}  // namespace relamp
