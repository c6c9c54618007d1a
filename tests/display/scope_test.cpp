#include "display/scope.h"

#include <gtest/gtest.h>

#include <numeric>

#include "base/error.h"

namespace relamp {
namespace {

/// Left half black, right half of the given colour.
std::vector<uint8_t> halves(int width, int height, uint8_t red, uint8_t green, uint8_t blue) {
    std::vector<uint8_t> pixels;
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            for (const int value : {int(red), int(green), int(blue), 255})
                pixels.push_back(2 * x < width && (pixels.size() & 3) != 3 ? 0 : uint8_t(value));
    return pixels;
}

TEST(Scope, CountsLevelsWhereTheyAre) {
    const Scope scope = scopeOf(halves(Scope::columns * 2, 10, 255, 128, 16), Scope::columns * 2, 10);
    EXPECT_EQ(scope.pixels, uint32_t(Scope::columns * 2 * 10));
    EXPECT_EQ(scope.waveform[0][0][0], 20u);
    EXPECT_EQ(scope.waveform[0][Scope::columns - 1][Scope::levels - 1], 20u);
    EXPECT_EQ(scope.waveform[1][Scope::columns - 1][Scope::levels / 2], 20u);
    EXPECT_EQ(scope.histogram[2][0], scope.pixels / 2);
    EXPECT_EQ(scope.histogram[2][16 * Scope::levels / 256], scope.pixels / 2);
    EXPECT_FLOAT_EQ(scope.clippedDark, 0.5f);
    EXPECT_FLOAT_EQ(scope.clippedBright, 0.5f);
    for (const Scope::Levels& channel : scope.histogram)
        EXPECT_EQ(std::accumulate(channel.begin(), channel.end(), 0u), scope.pixels);
}

TEST(Scope, WhatIsNotCoveredIsLeftOut) {
    std::vector<uint8_t> pixels = halves(100, 10, 200, 200, 200);
    for (size_t i = 0; i < pixels.size(); i += 4)
        if (pixels[i] == 0) pixels[i + 3] = 0;
    const Scope scope = scopeOf(pixels, 100, 10);
    EXPECT_EQ(scope.pixels, 500u);
    EXPECT_EQ(scope.clippedDark, 0);
}

TEST(Scope, OfLargeAndSmallImages) {
    const Scope large = scopeOf(halves(2000, 1500, 100, 100, 100), 2000, 1500);
    EXPECT_LT(large.pixels, 400000u);
    EXPECT_FLOAT_EQ(large.clippedDark, 0.5f);
    EXPECT_EQ(scopeOf({}, 0, 0).pixels, 0u);
    EXPECT_EQ(scopeOf(halves(1, 1, 9, 9, 9), 1, 1).pixels, 1u);
    const std::vector<uint8_t> few(12);
    EXPECT_THROW(scopeOf(few, 2, 2), Error);
}

}  // namespace
}  // namespace relamp
