#include "scan/code_fit.h"

#include <bit>
#include <cmath>
#include <limits>
#include <optional>

#include "base/parallel.h"
#include "base/statistics.h"
#include "scan/affine_fit.h"

namespace relamp {
namespace {

using CodePlane = AffineFit<double>::Plane;

struct Crossing {
    float at = 0;  ///< from the first pixel to the second, 0 to 1
    float place = 0;
};

/// Between two neighbouring pixels; none where their codes are not exact neighbours.
std::optional<Crossing> crossingOf(const CodeMap& map, size_t a, size_t b) {
    const CodeInterval &first = map.codes[a], &second = map.codes[b];
    if (first.width() != 1 || second.width() != 1 || std::abs(int(first.low) - int(second.low)) != 1)
        return std::nullopt;
    const unsigned edge = std::max(first.low, second.low);
    const int bit = std::countr_zero(edge);
    if (bit >= crossingBits) return std::nullopt;
    const int before = map.contrast[a][size_t(bit)], after = map.contrast[b][size_t(bit)];
    if (before * after >= 0) return std::nullopt;
    return Crossing{float(before) / float(before - after), float(edge)};
}

class PlaceFit {
public:
    PlaceFit(const CodeMap& map, float slope) : map_(map) {
        const float covered = slope > 0 ? 1 / slope : 1;
        radius_ = std::clamp(int(std::ceil(covered)) + 1, 2, 6);
        gate_ = std::max(2.0f, 3 * slope * float(radius_));
    }

    float at(int x, int y) const {
        const CodeInterval own = map_.codes[index(x, y)];
        constexpr float none = std::numeric_limits<float>::quiet_NaN();
        if (own.width() == 0) return none;
        std::optional<CodePlane> plane;
        int counted = 0;
        for (int round = 0; round < 2; ++round) {
            const AffineFit<double> sums = gathered(x, y, plane, counted);
            plane = sums.solved();
            if (!plane) return none;
        }
        const int window = (2 * radius_ + 1) * (2 * radius_ + 1);
        const double off = std::abs(plane->at - double(own.middle()));
        if (counted * 3 < window || !(off <= 0.5 * own.width() + 0.75)) return none;
        return float(plane->at);
    }

private:
    size_t index(int x, int y) const { return size_t(y) * size_t(map_.width) + size_t(x); }

    AffineFit<double> gathered(int x, int y, const std::optional<CodePlane>& before, int& counted) const {
        AffineFit<double> sums;
        counted = 0;
        const float own = map_.codes[index(x, y)].middle();
        const auto near = [&](double dx, double dy, double place, double width) {
            if (!before) return std::abs(place - double(own)) <= double(gate_) + 0.5 * width;
            return std::abs(place - (before->at + before->alongX * dx + before->alongY * dy)) <= 0.75 + 0.5 * width;
        };
        for (int j = std::max(0, y - radius_); j <= std::min(map_.height - 1, y + radius_); ++j)
            for (int i = std::max(0, x - radius_); i <= std::min(map_.width - 1, x + radius_); ++i) {
                const CodeInterval code = map_.codes[index(i, j)];
                const int width = code.width();
                if (width == 0 || !near(i - x, j - y, double(code.middle()), width)) continue;
                ++counted;
                sums.add(i - x, j - y, double(code.middle()), 12.0 / (width * width));
                if (i < std::min(map_.width - 1, x + radius_)) addCrossing(sums, x, y, i, j, 1, 0, near);
                if (j < std::min(map_.height - 1, y + radius_)) addCrossing(sums, x, y, i, j, 0, 1, near);
            }
        return sums;
    }

    template <class Near>
    void addCrossing(AffineFit<double>& sums, int x, int y, int i, int j, int right, int down, const Near& near) const {
        const auto crossing = crossingOf(map_, index(i, j), index(i + right, j + down));
        if (!crossing) return;
        const double dx = i - x + right * double(crossing->at), dy = j - y + down * double(crossing->at);
        if (near(dx, dy, double(crossing->place), 0.5)) sums.add(dx, dy, double(crossing->place), 100);
    }

    const CodeMap& map_;
    int radius_ = 2;
    float gate_ = 2;
};

}  // namespace

float slopeOf(const CodeMap& map) {
    // Over some pixels, because most neighbours have one code.
    constexpr int apart = 8;
    std::vector<float> along[2];
    const auto w = size_t(map.width);
    for (int y = 0; y + apart < map.height; y += 3)
        for (int x = 0; x + apart < map.width; x += 3) {
            const size_t here = size_t(y) * w + size_t(x);
            for (const int axis : {0, 1}) {
                const size_t there = here + size_t(apart) * (axis ? w : 1);
                if (map.codes[here].width() == 0 || map.codes[there].width() == 0) continue;
                along[axis].push_back(std::abs(map.codes[here].middle() - map.codes[there].middle()) / apart);
            }
        }
    return std::max(medianOf(std::move(along[0])), medianOf(std::move(along[1])));
}

std::vector<float> fitPlaces(const CodeMap& map, float slope, Progress& progress) {
    std::vector<float> places(map.codes.size());
    const PlaceFit fit(map, slope);
    progress.begin("Fitting codes", size_t(map.height));
    parallelFor(
        size_t(map.height), 8,
        [&](size_t y) {
            for (int x = 0; x < map.width; ++x) places[y * size_t(map.width) + size_t(x)] = fit.at(x, int(y));
        },
        &progress);
    return places;
}

}  // namespace relamp
