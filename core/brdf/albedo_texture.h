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

/// Bilinear in an image of `width` by `height` texels, 2 at least.
inline TexelBlend texelBlend(const Vec2& place, int width, int height) {
    const float x = std::clamp(place.x - 0.5f, 0.0f, float(width - 1)),
                y = std::clamp(place.y - 0.5f, 0.0f, float(height - 1));
    const int x0 = std::min(int(x), width - 2), y0 = std::min(int(y), height - 2);
    const float fx = x - float(x0), fy = y - float(y0);
    const size_t at = size_t(y0) * size_t(width) + size_t(x0), below = at + size_t(width);
    return {{at, at + 1, below, below + 1}, {(1 - fx) * (1 - fy), fx * (1 - fy), (1 - fx) * fy, fx * fy}};
}

/// A smaller copy of a texture: each texel is the mean over a square of it, as far as charts lie there.
struct CoarserTexels {
    int width = 0, height = 0;
    std::vector<Rgb> texels;
};

/// Diffuse albedo per texel. A texel (x, y) has its centre at (x + 0.5, y + 0.5); row 0 is at the top.
struct AlbedoTexture {
    int width = 0, height = 0;
    /// Per triangle of the capture's mesh where its corners lie, texels; negative: the triangle has no texels.
    std::vector<std::array<Vec2, 3>> corners;
    std::vector<Rgb> texels;
    /// Per texel, of 255: how much of it rests on the photographs' pixels; texels that no photograph shows have 0.
    /// Empty: not known.
    std::vector<uint8_t> confidence{};
    std::vector<CoarserTexels> coarser{};  ///< of 2, 4, 8, 16 texels a side (texture/coarser_texels); empty: not made
    std::vector<Rgb> ofTriangle{};         ///< mean over each triangle, made with them

    bool has(uint32_t triangle) const { return triangle < corners.size() && corners[triangle][0].x >= 0; }
    /// `barycentric`: as a Hit has it.
    Vec2 place(uint32_t triangle, const Vec2& barycentric) const {
        const std::array<Vec2, 3>& c = corners[triangle];
        return (1 - barycentric.x - barycentric.y) * c[0] + barycentric.x * c[1] + barycentric.y * c[2];
    }
    TexelBlend blendAt(const Vec2& place) const { return texelBlend(place, width, height); }
    /// Bilinear.
    Rgb at(const Vec2& place) const {
        const TexelBlend blend = blendAt(place);
        Rgb sum(0);
        for (size_t k = 0; k < 4; ++k) sum += blend.weight[k] * texels[blend.texel[k]];
        return sum;
    }
    /// Mean over a footprint at a place of a triangle: a parallelogram with these sides, texels. Up to a texel it is
    /// at(). Wider ones are read from the coarser copies, at eight places along their longer side at most. No copy is
    /// coarser than the triangle is wide, since the next chart lies beyond it; beyond that the triangle's mean counts.
    /// Footprints end at the triangle. Where cells are wider than the gap between charts, 2 % of another chart may come
    /// in.
    Rgb over(uint32_t triangle, const Vec2& place, const Vec2& side, const Vec2& otherSide) const;
    /// In [0, 1], bilinear; 1 where it is not known.
    float confidenceAt(const Vec2& place) const {
        if (confidence.empty()) return 1;
        const TexelBlend blend = blendAt(place);
        float sum = 0;
        for (size_t k = 0; k < 4; ++k) sum += blend.weight[k] * float(confidence[blend.texel[k]]);
        return sum / 255;
    }
};

}  // namespace relamp
