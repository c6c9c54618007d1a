// Which texels a triangle covers.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>

#include "base/math.h"

namespace relamp {

inline float crossOf(const Vec2& a, const Vec2& b) { return a.x * b.y - a.y * b.x; }

/// Calls back with the texels of an image whose centres lie inside the triangle, not on its edges; stops where that
/// returns false. Row by row, so that slivers cost their height.
template <class TakeTexel>
void texelsInside(std::array<Vec2, 3> p, int width, int height, TakeTexel&& take) {
    float area = crossOf(p[1] - p[0], p[2] - p[0]);
    if (area < 0) {
        std::swap(p[1], p[2]);
        area = -area;
    }
    if (!(area > 0)) return;
    constexpr float inset = 1e-3f;  // centres on an edge belong to both sides
    const float low = std::min({p[0].y, p[1].y, p[2].y}), high = std::max({p[0].y, p[1].y, p[2].y});
    for (int y = std::max(0, int(low - 0.5f)); y <= std::min(height - 1, int(high)); ++y) {
        // Of each edge the part of the row on its inner side: a + b x > inset x area.
        float from = 0, to = float(width);
        for (size_t k = 0; k < 3; ++k) {
            const Vec2 along = p[(k + 1) % 3] - p[k];
            const float b = -along.y, a = along.x * (float(y) + 0.5f - p[k].y) + along.y * p[k].x - inset * area;
            if (b > 0) from = std::max(from, -a / b);
            else if (b < 0) to = std::min(to, -a / b);
            else if (!(a > 0)) to = -1;
        }
        for (int x = std::max(0, int(std::ceil(from - 0.5f))); float(x) + 0.5f < to && x < width; ++x)
            if (!take(size_t(y) * size_t(width) + size_t(x))) return;
    }
}

/// The same in a square image.
template <class TakeTexel>
void texelsInside(const std::array<Vec2, 3>& p, int side, TakeTexel&& take) {
    texelsInside(p, side, side, std::forward<TakeTexel>(take));
}

}  // namespace relamp
