// What may tell the scale of light against albedo.
#include <gtest/gtest.h>

#include "solve/steps/steps.h"

namespace relamp {
namespace {

TEST(Gauge, HighlightsBeforeABackdropTellNoScale) {
    LightUncertainty light;
    light.fromGloss = Rgb(0.9f);
    light.fromBounces = Rgb(0.1f);
    EXPECT_TRUE(glossAlone(light, true));
    EXPECT_FALSE(glossAlone(light, false)) << "background that is seen tells how strong they are";
    light.fromBounces = Rgb(0.95f);
    EXPECT_FALSE(glossAlone(light, true)) << "surfaces that light each other";
    light.fromBounces = Rgb(0);
    light.fromProbes = Rgb(1);
    EXPECT_FALSE(glossAlone(light, true)) << "a probe holds the light";
}

TEST(Gauge, LittleLightTellsLittleOfTheScale) {
    EXPECT_NEAR(scaleSigmaByModel(0.3, 0.4), 0.04f, 1e-6f);
    EXPECT_NEAR(scaleSigmaByModel(0, 0.2), 0.1f, 1e-6f);
    EXPECT_GT(scaleSigmaByModel(0, 0.05), 0.35f) << "no better than what is assumed where nothing tells";
    EXPECT_TRUE(std::isfinite(scaleSigmaByModel(0, 0)));
}

TEST(Gauge, BouncedLightThatLightOutgrowsNeedsMoreEvidence) {
    EXPECT_EQ(mostLeftByBounce(0.2f, 0.21f, true), 0.99);
    EXPECT_EQ(mostLeftByBounce(0.35f, 0.59f, true), 0.99) << "the light was too strong without it";
    EXPECT_EQ(mostLeftByBounce(0.016f, 0.146f, true), 0.97);
    EXPECT_EQ(mostLeftByBounce(0.016f, 0.146f, false), 0.99) << "nothing else tells the scale";
}

TEST(Gauge, MetalHelpsTheBackgroundAndNotBouncedLight) {
    LightUncertainty light;
    light.fromBackground = Rgb(0.9f);
    EXPECT_TRUE(restsOnPartOfLight(light, false));
    EXPECT_FALSE(restsOnPartOfLight(light, true));
    light.fromBackground = Rgb(0);
    light.fromBounces = Rgb(1);
    EXPECT_TRUE(restsOnPartOfLight(light, true)) << "1 % of the light would tell the scale to 5 %";
    light.fromBounces = Rgb(0);
    light.fromEmitters = Rgb(1);
    EXPECT_FALSE(restsOnPartOfLight(light, false));
}

}  // namespace
}  // namespace relamp
