#include "capture/colour_agreement.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/parallel.h"
#include "base/statistics.h"

namespace relamp {
namespace {

constexpr size_t mostColourViews = 24, leastPairs = 300;
constexpr int cellsTried = 8;    // cells
constexpr float mostChange = 1;  // of a logarithm
constexpr double mostBlocks = 4e6;
constexpr float notKnown = std::numeric_limits<float>::quiet_NaN();

/// Logarithms of brightness in square cells of an image.
struct Cells {
    int width = 0, height = 0;
    std::vector<float> value;  ///< NaN: not known
    Cells(int w, int h) : width(w), height(h), value(size_t(w) * size_t(h), notKnown) {}
    float at(int x, int y) const {
        return x < 0 || y < 0 || x >= width || y >= height ? notKnown : value[size_t(y) * size_t(width) + size_t(x)];
    }
};

/// Sums over all pixels above and to the left, so that the mean over any square takes four of them.
class PhotographSums {
public:
    /// In blocks of `block` pixels a side, which bound the memory.
    PhotographSums(const Image& image, int block)
        : block_(block),
          width_((image.width + block - 1) / block),
          height_((image.height + block - 1) / block),
          sum_(size_t(width_ + 1) * size_t(height_ + 1), 0.0),
          count_(sum_.size(), 0.0) {
        for (int y = 0; y < image.height; ++y)
            for (int x = 0; x < image.width; ++x) {
                const float light = luminance(image.at(x, y));
                if (!image.usableAt(x, y) || !(light > 0)) continue;
                sum_[at(x / block + 1, y / block + 1)] += double(std::log(light));
                ++count_[at(x / block + 1, y / block + 1)];
            }
        for (std::vector<double>* sums : {&sum_, &count_})
            for (int y = 1; y <= height_; ++y)
                for (int x = 1; x <= width_; ++x)
                    (*sums)[at(x, y)] += (*sums)[at(x - 1, y)] + (*sums)[at(x, y - 1)] - (*sums)[at(x - 1, y - 1)];
    }
    /// Mean over the square; NaN where less than half of it counts.
    float mean(double x0, double y0, double side) const {
        const auto bound = [&](double v, int most) { return std::clamp(int(std::lround(v / block_)), 0, most); };
        const int l = bound(x0, width_), r = bound(x0 + side, width_), t = bound(y0, height_),
                  b = bound(y0 + side, height_);
        const double n = count_[at(r, b)] - count_[at(l, b)] - count_[at(r, t)] + count_[at(l, t)];
        if (!(n > 0.5 * side * side)) return notKnown;
        return float((sum_[at(r, b)] - sum_[at(l, b)] - sum_[at(r, t)] + sum_[at(l, t)]) / n);
    }

private:
    int block_, width_, height_;
    std::vector<double> sum_, count_;
    size_t at(int x, int y) const { return size_t(y) * size_t(width_ + 1) + size_t(x); }
};

struct Correlation {
    double value = 0;
    size_t pairs = 0;
};

/// Of the changes from cell to cell: light that changes slowly has no part in them.
Correlation correlationOf(const Cells& colours, const Cells& photograph, int dx, int dy) {
    double both = 0, ofColours = 0, ofPhotograph = 0;
    size_t pairs = 0;
    for (int y = 0; y < colours.height; ++y)
        for (int x = 0; x < colours.width; ++x) {
            const float here = colours.at(x, y), shown = photograph.at(x + dx, y + dy);
            if (std::isnan(here) || std::isnan(shown)) continue;
            for (const auto& [nx, ny] : {std::pair{1, 0}, std::pair{0, 1}}) {
                const float there = colours.at(x + nx, y + ny), shownThere = photograph.at(x + nx + dx, y + ny + dy);
                if (std::isnan(there) || std::isnan(shownThere)) continue;
                const double a = std::clamp(double(there - here), -double(mostChange), double(mostChange)),
                             b = std::clamp(double(shownThere - shown), -double(mostChange), double(mostChange));
                both += a * b;
                ofColours += a * a;
                ofPhotograph += b * b;
                ++pairs;
            }
        }
    return {ofColours > 0 && ofPhotograph > 0 ? both / std::sqrt(ofColours * ofPhotograph) : 0.0, pairs};
}

Cells photographCells(const PhotographSums& sums, int width, int height, double cell, const Vec2& shift) {
    Cells cells(width, height);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            cells.value[size_t(y) * size_t(width) + size_t(x)] =
                sums.mean(x * cell + double(shift.x), y * cell + double(shift.y), cell);
    return cells;
}

/// Middle of the parabola through three values around the largest, in steps.
double peakOf(double before, double here, double after) {
    const double bend = before - 2 * here + after;
    return bend < 0 ? std::clamp(0.5 * (before - after) / bend, -0.5, 0.5) : 0.0;
}

std::optional<ColourView> compared(const View& view, const Mesh& mesh, const MeshColours& colours,
                                   const std::vector<uint8_t>& sees, const Progress& progress) {
    if (view.image.pixels.empty()) return std::nullopt;
    struct Place {
        Vec2 pixel;
        float light;
    };
    std::vector<Place> places;
    for (uint32_t v = 0; v < mesh.vertexCount(); ++v) {
        if (!sees[v] || !colours.painted[v] || !(luminance(colours.linear[v]) > 1e-4f)) continue;
        if (const auto pixel = view.camera.project(DVec3(mesh.positions[v])))
            places.push_back({*pixel, std::log(luminance(colours.linear[v]))});
    }
    if (places.size() < leastPairs) return std::nullopt;
    // Cells that hold one vertex or two: finer ones would lie apart.
    Vec2 low(1e30f), high(-1e30f);
    for (const Place& p : places) low = glm::min(low, p.pixel), high = glm::max(high, p.pixel);
    const double area = double(high.x - low.x) * double(high.y - low.y);
    const double cell =
        std::clamp(1.5 * std::sqrt(area / double(places.size())), 2.0, std::max(2.0, double(view.camera.width) / 40));
    const int width = int(std::ceil(double(view.camera.width) / cell)),
              height = int(std::ceil(double(view.camera.height) / cell));
    Cells painted(width, height);
    std::vector<float> count(painted.value.size(), 0);
    for (const Place& p : places) {
        const size_t x = size_t(std::clamp(int(double(p.pixel.x) / cell), 0, width - 1)),
                     y = size_t(std::clamp(int(double(p.pixel.y) / cell), 0, height - 1)), i = y * size_t(width) + x;
        painted.value[i] = (count[i] > 0 ? painted.value[i] : 0.0f) + p.light;
        ++count[i];
    }
    for (size_t i = 0; i < count.size(); ++i)
        if (count[i] > 0) painted.value[i] /= count[i];
    progress.check();
    const double pixels = double(view.image.width) * double(view.image.height);
    const int block = std::max({1, int(cell / 8), int(std::ceil(std::sqrt(pixels / mostBlocks)))});
    const PhotographSums sums(view.image, block);
    const Cells shown = photographCells(sums, width, height, cell, Vec2(0));
    ColourView result;
    result.name = view.name;
    result.cell = cell;
    const Correlation still = correlationOf(painted, shown, 0, 0);
    if (still.pairs < leastPairs) return std::nullopt;
    result.asPlaced = result.correlation = still.value;
    result.compared = still.pairs;
    int bestX = 0, bestY = 0;
    for (int dy = -cellsTried; dy <= cellsTried; ++dy)
        for (int dx = -cellsTried; dx <= cellsTried; ++dx) {
            const Correlation c = correlationOf(painted, shown, dx, dy);
            if (c.pairs < still.pairs / 2 || c.value <= result.correlation) continue;
            result.correlation = c.value;
            bestX = dx, bestY = dy;
        }
    progress.check();
    // In fourths of a cell, and between them. Means are over whole blocks.
    const double step = std::max(cell / 4, double(block));
    Vec2 best(float(bestX * cell), float(bestY * cell));
    const auto at = [&](const Vec2& shift) {
        return correlationOf(painted, photographCells(sums, width, height, cell, shift), 0, 0).value;
    };
    double here = result.correlation;
    for (int round = 0; round < 6; ++round) {
        Vec2 next = best;
        for (const Vec2& d : {Vec2(1, 0), Vec2(-1, 0), Vec2(0, 1), Vec2(0, -1)})
            if (const double c = at(best + float(step) * d); c > here) here = c, next = best + float(step) * d;
        if (next == best) break;
        best = next;
    }
    const float s = float(step);
    result.correlation = here;
    result.shift = best + s * Vec2(float(peakOf(at(best - Vec2(s, 0)), here, at(best + Vec2(s, 0)))),
                                   float(peakOf(at(best - Vec2(0, s)), here, at(best + Vec2(0, s)))));
    return result;
}

}  // namespace

const ColourView& ColourAgreement::worst() const {
    return *std::max_element(views.begin(), views.end(), [](const ColourView& a, const ColourView& b) {
        return glm::length(a.shift) < glm::length(b.shift);
    });
}

ColourAgreement colourAgreement(const Capture& capture, const MeshColours& colours,
                                const std::vector<ViewSight>& sights, Progress& progress) {
    ColourAgreement result;
    if (colours.empty()) return result;
    const size_t count = std::min(capture.views.size(), mostColourViews);
    std::vector<std::optional<ColourView>> views(count);
    progress.begin("Comparing photographs with the mesh's colours", count);
    parallelFor(
        count, 1,
        [&](size_t k) {
            const size_t i = k * capture.views.size() / count;
            views[k] = compared(capture.views[i], capture.mesh, colours, sights[i].sees, progress);
        },
        &progress);
    std::vector<double> shifts, correlations;
    for (std::optional<ColourView>& view : views) {
        if (!view) continue;
        shifts.push_back(double(glm::length(view->shift)));
        correlations.push_back(view->correlation);
        result.views.push_back(std::move(*view));
    }
    if (shifts.empty()) return result;
    result.shift = medianOf(std::move(shifts));
    result.correlation = medianOf(std::move(correlations));
    return result;
}

}  // namespace relamp
