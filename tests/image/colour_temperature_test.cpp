#include "image/colour_temperature.h"

#include <gtest/gtest.h>

namespace relamp {
namespace {

TEST(ColourTemperature, MeetsPublishedChromaticities) {
    const struct {
        float kelvin, x, y, tolerance;
        const char* name;
    } known[] = {{2856, 0.4476f, 0.4074f, 6e-4f, "CIE illuminant A"},
                 {6504, 0.3127f, 0.3290f, 2e-4f, "CIE D65"},
                 {5003, 0.3457f, 0.3585f, 4e-4f, "CIE D50"},
                 {7504, 0.2990f, 0.3149f, 2e-4f, "CIE D75"},
                 {2000, 0.5267f, 0.4133f, 8e-4f, "glowing part, 2000 K"},
                 {3000, 0.4369f, 0.4041f, 8e-4f, "glowing part, 3000 K"}};
    for (const auto& k : known) {
        const Vec2 xy = kelvinChromaticity(k.kelvin);
        EXPECT_NEAR(xy.x, k.x, k.tolerance) << k.name;
        EXPECT_NEAR(xy.y, k.y, k.tolerance) << k.name;
    }
}

TEST(ColourTemperature, D65IsWhite) {
    const Rgb white = kelvinTint(whiteKelvin);
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(white[k], 1, 1.5e-3) << k;
}

TEST(ColourTemperature, TintsHaveLuminanceOneAndGoFromRedToBlue) {
    float before = 1e9f;
    for (float kelvin = lowestKelvin; kelvin <= highestKelvin; kelvin *= 1.05f) {
        const Rgb c = kelvinTint(kelvin);
        EXPECT_NEAR(luminance(c), 1, 1e-5) << kelvin;
        EXPECT_GE(std::min({c.x, c.y, c.z}), 0) << kelvin;
        EXPECT_LT(c.x / c.y, before) << kelvin;
        before = c.x / c.y;
    }
    EXPECT_GT(kelvinTint(10000).z, kelvinTint(10000).x);
}

TEST(ColourTemperature, ComesBackFromItsTint) {
    for (const float kelvin : {2000.0f, 2400.0f, 2700.0f, 3200.0f, 4000.0f, 4300.0f, 5000.0f, 5600.0f, 6504.0f, 9000.0f,
                               15000.0f, 24000.0f}) {
        const NearestKelvin back = nearestKelvin(kelvinTint(kelvin) * 7.0f);
        EXPECT_NEAR(back.kelvin / kelvin, 1, 5e-3) << kelvin;
        EXPECT_LT(back.distance, 1e-4f) << kelvin;
    }
}

TEST(ColourTemperature, OddColoursGiveAFiniteAnswer) {
    EXPECT_EQ(nearestKelvin(Rgb(0)).kelvin, whiteKelvin);
    EXPECT_NEAR(nearestKelvin(Rgb(1)).kelvin, whiteKelvin, 60);
    for (const Rgb& c : {Rgb(1, 0, 0), Rgb(0, 1, 0), Rgb(0, 0, 1), Rgb(1, 0, 1), Rgb(-1, 2, 0), Rgb(1e20f, 1, 1)}) {
        const NearestKelvin n = nearestKelvin(c);
        EXPECT_TRUE(n.kelvin >= lowestKelvin && n.kelvin <= highestKelvin);
        EXPECT_TRUE(std::isfinite(n.distance));
    }
    EXPECT_GT(nearestKelvin(Rgb(0, 1, 0)).distance, 0.02f);
    for (const float kelvin : {-5.0f, 0.0f, 1e9f}) EXPECT_TRUE(isFinite(kelvinTint(kelvin)));
}

}  // namespace
}  // namespace relamp
