// Noise of a frame's light, taken out where surfaces are matte: non-local means with the variance that two halves of
// the samples show, guided by normals and positions ([Rousselle12]). Light is filtered
// without the surfaces' colours, so prints stay as sharp as they are.
#pragma once
#include <array>
#include <vector>

#include "base/math.h"

namespace relamp {

/// What the pixels of an image show of matte surfaces; row by row.
struct SurfaceGuide {
    int width = 0, height = 0;
    std::vector<Vec3> normal, position;  ///< means over the pixel
    std::vector<float> footprint;        ///< metres across the surface; 0: no matte surface, the pixel is left alone
};

/// Light of one group (radiance of a white matte surface), from each half of a pixel's samples.
using HalfLight = std::array<std::vector<Rgb>, 2>;

/// Rows that denoisedLight looks at above and below those it gives.
inline constexpr int denoiseMargin = 10;

/// The mean of the halves with less noise, for `rows` rows from `firstRow` on: one image a group. Each half is averaged
/// over 11 x 11 pixels with weights from the other half. Weights are 1 where 3 x 3 patches differ by no more than their
/// noise, and fall off beyond. Bits depend on no more than denoiseMargin rows about a pixel, nor on threads. About 0.1
/// seconds for a group of 640 x 480 on two cores.
std::vector<std::vector<Rgb>> denoisedLight(const SurfaceGuide& guide, const std::vector<HalfLight>& groups,
                                            int firstRow, int rows);

}  // namespace relamp
