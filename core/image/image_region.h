// A rectangle of an image, by fractions of its sides or by pixels.
#pragma once
#include <algorithm>
#include <cmath>

#include "base/math.h"

namespace relamp {

/// Fractions of width and height in [0, 1], y down; `low` is the corner at the top left.
struct ImageRegion {
    Vec2 low{0}, high{1};
    bool operator==(const ImageRegion&) const = default;
};

struct ImageBox {
    int left = 0, top = 0, width = 0, height = 0;
    bool operator==(const ImageBox&) const = default;
};

/// The pixels that the region touches, at least one, all inside an image of this size (at least 1 x 1).
inline ImageBox boxOf(const ImageRegion& region, int width, int height) {
    const auto side = [](float low, float high, int n) {
        const int from = std::clamp(int(std::floor(double(low) * n + 1e-3)), 0, n - 1);
        return std::pair(from, std::clamp(int(std::ceil(double(high) * n - 1e-3)) - from, 1, n - from));
    };
    const auto [left, w] = side(region.low.x, region.high.x, width);
    const auto [top, h] = side(region.low.y, region.high.y, height);
    return {left, top, w, h};
}

}  // namespace relamp
