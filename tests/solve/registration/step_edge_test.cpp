// A step in a profile is found where it is; a bend, noise and two equal steps are none.
#include "solve/registration/step_edge.h"

#include <gtest/gtest.h>

#include "base/random.h"

namespace relamp {
namespace {

/// Two sides with a slope each, a step between them as wide as a pixel, and noise.
Profile profileWith(float step, const Rgb& before, const Rgb& after, float noise = 0, uint64_t seed = 1) {
    Profile profile;
    for (size_t j = 0; j < profileSize; ++j) {
        const float t = profileStep * (float(j) - float(profileSize / 2));
        const float beyond = std::clamp(t - step + 0.5f, 0.0f, 1.0f);
        const float random = 2 * randomShift(seed, j, 0).x - 1;
        profile[j] = (1 - beyond) * before * (1 + 0.02f * t) + beyond * after * (1 - 0.03f * t) +
                     Rgb(std::sqrt(3.0f) * noise * random);
    }
    return profile;
}

TEST(StepEdge, IsFoundToATenthOfAPixel) {
    for (const float at : {-3.2f, -1.4f, 0.0f, 0.33f, 2.6f}) {
        const std::optional<float> found = findStep(profileWith(at, Rgb(1.4f, 1, 1), Rgb(0.5f, 0.8f, 1)), 0.03f);
        ASSERT_TRUE(found) << at;
        EXPECT_NEAR(*found, at, 0.1f);
    }
}

TEST(StepEdge, IsFoundWithinNoise) {
    for (uint64_t seed = 1; seed <= 20; ++seed) {
        const std::optional<float> found = findStep(profileWith(0.7f, Rgb(1.5f), Rgb(0.5f), 0.03f, seed), 0.03f);
        ASSERT_TRUE(found) << seed;
        EXPECT_NEAR(*found, 0.7f, 0.3f);
    }
}

TEST(StepEdge, IsNoneInABendAndInNoise) {
    EXPECT_FALSE(findStep(profileWith(0, Rgb(1), Rgb(1)), 0.03f));
    for (uint64_t seed = 1; seed <= 20; ++seed)
        EXPECT_FALSE(findStep(profileWith(0, Rgb(1), Rgb(1), 0.03f, seed), 0.03f)) << seed;
}

TEST(StepEdge, IsNoneBeyondItsReach) { EXPECT_FALSE(findStep(profileWith(5.2f, Rgb(1.5f), Rgb(0.5f)), 0.03f)); }

TEST(StepEdge, IsNoneWhereTwoAreAsClear) {
    Profile profile;
    for (size_t j = 0; j < profileSize; ++j) {
        const float t = profileStep * (float(j) - float(profileSize / 2));
        profile[j] = Rgb(1.5f - 0.5f * float(t > -2) - 0.5f * float(t > 2));
    }
    EXPECT_FALSE(findStep(profile, 0.03f));
}

}  // namespace
}  // namespace relamp
