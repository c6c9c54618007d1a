// Waveform and histogram of an image as it is shown: how bright it is, and where.
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace relamp {

/// Counts of display values.
struct Scope {
    static constexpr int columns = 192, levels = 96;
    using Levels = std::array<uint32_t, levels>;
    /// By channel and column, the image's left column first: how many of its pixels have a level, level 0 darkest.
    std::array<std::vector<Levels>, 3> waveform;
    std::array<Levels, 3> histogram{};         ///< by channel, over the whole image
    uint32_t pixels = 0;                       ///< that were looked at
    float clippedDark = 0, clippedBright = 0;  ///< fraction of the pixels with a channel at 0, or at 255
};

/// `rgba`: width x height pixels of 8 bits, row after row; those whose alpha is below 128 show nothing and are left
/// out. Of large images every n-th row is looked at, about 300 000 pixels in all. Throws Error when there are fewer
/// bytes than pixels. Cost: 2 ms.
Scope scopeOf(std::span<const uint8_t> rgba, int width, int height);

}  // namespace relamp
