// Albedo finer than the mesh: an image in which every corner of every triangle has its place.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "base/math.h"

namespace relamp {

/// Four texels around a place, and how much each counts.
struct TexelBlend {
    std::array<size_t, 4> texel;
    std::array<float, 4> weight;
};

/// Diffuse albedo per texel. A texel (x, y) has its centre at (x + 0.5, y + 0.5); row 0 is at the top.
struct AlbedoTexture {
    int width = 0, height = 0;
    /// Per triangle of the capture's mesh where its corners lie, texels; negative: the triangle has no texels.
    std::vector<std::array<Vec2, 3>> corners;
    std::vector<Rgb> texels;

    bool has(uint32_t triangle) const { return triangle < corners.size() && corners[triangle][0].x >= 0; }
    /// `barycentric`: as a Hit has it.
    Vec2 place(uint32_t triangle, const Vec2& barycentric) const {
        const std::array<Vec2, 3>& c = corners[triangle];
        return (1 - barycentric.x - barycentric.y) * c[0] + barycentric.x * c[1] + barycentric.y * c[2];
    }
    TexelBlend blendAt(const Vec2& place) const {
        const float x = std::clamp(place.x - 0.5f, 0.0f, float(width - 1)),
                    y = std::clamp(place.y - 0.5f, 0.0f, float(height - 1));
        const int x0 = std::min(int(x), width - 2), y0 = std::min(int(y), height - 2);
        const float fx = x - float(x0), fy = y - float(y0);
        const size_t at = size_t(y0) * size_t(width) + size_t(x0), below = at + size_t(width);
        return {{at, at + 1, below, below + 1}, {(1 - fx) * (1 - fy), fx * (1 - fy), (1 - fx) * fy, fx * fy}};
    }
    /// Bilinear.
    Rgb at(const Vec2& place) const {
        const TexelBlend blend = blendAt(place);
        Rgb sum(0);
        for (size_t k = 0; k < 4; ++k) sum += blend.weight[k] * texels[blend.texel[k]];
        return sum;
    }
};

}  // namespace relamp
