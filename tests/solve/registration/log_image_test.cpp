#include "solve/registration/log_image.h"

#include <gtest/gtest.h>

namespace relamp {
namespace {

/// Luminance exp(0.02 x - 0.03 y), x and y of pixel centres: a plane in its logarithm.
Image ramp(int width, int height) {
    Image image(width, height);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            image.at(x, y) = Rgb(std::exp(0.02f * (float(x) + 0.5f) - 0.03f * (float(y) + 0.5f)));
    return image;
}

TEST(LogImage, HasTheSlopeOfAPlaneInTheLogarithm) {
    const LogImage image(ramp(40, 30), 1, 0.8f, 0);
    const LogImage::At at = image.at({20.3f, 14.8f});
    ASSERT_TRUE(at.valid);
    EXPECT_NEAR(at.slope.x, 0.02f, 1e-4f);
    EXPECT_NEAR(at.slope.y, -0.03f, 1e-4f);
    // A Gaussian of 0.8 pixels raises an exponential by exp(slope^2 sigma^2 / 2).
    EXPECT_NEAR(at.value, 0.02f * 20.3f - 0.03f * 14.8f + 0.64f * 0.0013f / 2, 1e-3f);
}

TEST(LogImage, MadeSmallerSaysTheSameOfTheSamePlace) {
    const LogImage image(ramp(120, 90), 3, 0.8f, 0);
    const LogImage::At at = image.at({60.4f, 45.1f});
    ASSERT_TRUE(at.valid);
    EXPECT_NEAR(at.slope.x, 0.02f, 1e-3f);
    EXPECT_NEAR(at.slope.y, -0.03f, 1e-3f);
    EXPECT_NEAR(at.value, 0.02f * 60.4f - 0.03f * 45.1f, 0.01f);
}

TEST(LogImage, HasNoValueBesideMaskedPixelsAndOutside) {
    Image image = ramp(40, 30);
    image.usable.assign(size_t(40 * 30), 1);
    for (int y = 0; y < 30; ++y)
        for (int x = 0; x < 10; ++x) {
            image.usable[size_t(y * 40 + x)] = 0;
            image.at(x, y) = Rgb(1e6f);
        }
    const LogImage blurred(image, 1, 1.5f, 0);
    EXPECT_FALSE(blurred.at({10.5f, 15}).valid);
    const LogImage::At beyond = blurred.at({16.5f, 15.5f});
    ASSERT_TRUE(beyond.valid);
    EXPECT_NEAR(beyond.value, 0.02f * 16.5f - 0.03f * 15.5f, 0.01f);
    for (const Vec2 outside : {Vec2(-5, 10), Vec2(0.5f, 10), Vec2(39.5f, 10), Vec2(20, 29.5f), Vec2(1e9f, 1e9f)})
        EXPECT_FALSE(blurred.at(outside).valid);
    EXPECT_FALSE(blurred.at(Vec2(std::numeric_limits<float>::quiet_NaN(), 5)).valid);
}

TEST(LogImage, OfATinyPhotographHasNoValues) {
    EXPECT_FALSE(LogImage(ramp(4, 4), 1, 3, 1e-6f).at({2, 2}).valid);
    EXPECT_FALSE(LogImage(ramp(4, 4), 8, 3, 1e-6f).at({2, 2}).valid);
}

}  // namespace
}  // namespace relamp
