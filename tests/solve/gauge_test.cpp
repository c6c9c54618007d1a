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

}  // namespace
}  // namespace relamp
