// Which texels a triangle covers.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>

#include "base/parallel.h"
#include "brdf/albedo_texture.h"

namespace relamp {

inline float crossOf(const Vec2& a, const Vec2& b) { return a.x * b.y - a.y * b.x; }

/// Rows of an image, from `begin` to before `end`.
struct TexelRows {
    int begin = 0, end = 0;
};

/// Calls back with the texels in these rows of an image whose centres lie inside the triangle, not on its edges; stops
/// where that returns false. Row by row, so that slivers cost their height.
template <class TakeTexel>
void texelsInside(std::array<Vec2, 3> p, int width, const TexelRows& rows, TakeTexel&& take) {
    float area = crossOf(p[1] - p[0], p[2] - p[0]);
    if (area < 0) {
        std::swap(p[1], p[2]);
        area = -area;
    }
    if (!(area > 0)) return;
    constexpr float inset = 1e-3f;  // centres on an edge belong to both sides
    const float low = std::min({p[0].y, p[1].y, p[2].y}), high = std::max({p[0].y, p[1].y, p[2].y});
    for (int y = std::max(rows.begin, int(low - 0.5f)); y <= std::min(rows.end - 1, int(high)); ++y) {
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

/// The same in a whole image.
template <class TakeTexel>
void texelsInside(const std::array<Vec2, 3>& p, int width, int height, TakeTexel&& take) {
    texelsInside(p, width, TexelRows{0, height}, std::forward<TakeTexel>(take));
}

/// And in a square one.
template <class TakeTexel>
void texelsInside(const std::array<Vec2, 3>& p, int side, TakeTexel&& take) {
    texelsInside(p, side, side, std::forward<TakeTexel>(take));
}

/// Calls body(triangle, rows) on all cores for bands of rows and every triangle that has texels in them or within a
/// texel of them. In one band triangles come in their order, so that of two that write to one texel the same one is
/// last on any number of threads.
template <class Body>
void trianglesByRows(const AlbedoTexture& texture, Body&& body) {
    constexpr int band = 64;
    const size_t bands = size_t(texture.height + band - 1) / band;
    const auto bandsOf = [&](uint32_t t) {
        const std::array<Vec2, 3>& p = texture.corners[t];
        const float low = std::min({p[0].y, p[1].y, p[2].y}), high = std::max({p[0].y, p[1].y, p[2].y});
        return std::pair(size_t(std::max(0, int(low) - 2) / band),
                         std::min(bands - 1, size_t(std::max(0, int(high) + 2) / band)));
    };
    std::vector<std::vector<uint32_t>> inBand(bands);
    for (uint32_t t = 0; t < texture.corners.size(); ++t) {
        if (!texture.has(t)) continue;
        const auto [first, last] = bandsOf(t);
        for (size_t b = first; b <= last; ++b) inBand[b].push_back(t);
    }
    parallelFor(bands, 1, [&](size_t b) {
        const TexelRows rows{int(b) * band, std::min(texture.height, int(b + 1) * band)};
        for (const uint32_t t : inBand[b]) body(t, rows);
    });
}

}  // namespace relamp
