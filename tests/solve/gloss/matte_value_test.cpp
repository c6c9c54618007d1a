#include <gtest/gtest.h>

#include <random>

#include "solve/gloss/matte.h"

namespace relamp {
namespace {

/// Mean over many vertices of what `quantile` makes of nine observations: radiance 1 with noise of 10 %, and `gloss`
/// more in two of three views.
double meanMatteValue(float quantile, float gloss) {
    std::mt19937 random(1);
    std::normal_distribution<float> noise(0, 0.1f);
    double sum = 0;
    constexpr int places = 2000;
    for (int v = 0; v < places; ++v) {
        std::vector<MatteObservation> seen;
        for (int k = 0; k < 9; ++k) seen.push_back({1 + noise(random) + (k % 3 ? gloss : 0), 1, 0.1f});
        sum += double(robustMatteValue(seen, quantile).radiance);
    }
    return sum / places;
}

TEST(MatteValue, NoiseIsNoGloss) {
    EXPECT_NEAR(meanMatteValue(0.5f, 0), 1, 0.005);
    EXPECT_NEAR(meanMatteValue(0.25f, 0), 1, 0.01);
}

TEST(MatteValue, ALowQuantileLeavesGlossOut) {
    EXPECT_NEAR(meanMatteValue(0.25f, 1), 1, 0.05);
    EXPECT_GT(meanMatteValue(0.5f, 1), 1.9);
}

TEST(BackgroundOverSurfaces, RimsThatAnInexactMeshLacksAreNoLight) {
    MatteObservations matte;
    for (int i = 0; i < 100; ++i) matte.radiance.push_back(Rgb(0.5f + 0.01f * float(i)));
    RadianceSamples samples;
    samples.background.assign(size_t(samples.backgroundGrid.cells()), Rgb(0));
    samples.backgroundPixels.assign(samples.background.size(), 9);
    EXPECT_EQ(backgroundOverSurfaces(samples, matte), 0);
    for (size_t c = 0; c < samples.background.size() / 50; ++c) samples.background[c] = Rgb(0.8f);
    EXPECT_NEAR(backgroundOverSurfaces(samples, matte), 0.8, 0.01);
    EXPECT_EQ(backgroundOverSurfaces(samples, matte, true), 0);
    samples.background[0] = Rgb(30);
    EXPECT_NEAR(backgroundOverSurfaces(samples, matte, true), 30, 0.5) << "brighter than any surface: a light";
    for (size_t c = 0; c < samples.background.size() / 10; ++c) samples.background[c] = Rgb(0.8f);
    EXPECT_NEAR(backgroundOverSurfaces(samples, matte, true), 0.8, 0.01) << "more than rims";
}

}  // namespace
}  // namespace relamp
