// Which patches of known albedo are believed.
#include "solve/known_patch.h"

#include <gtest/gtest.h>

namespace relamp {
namespace {

using Used = std::vector<uint8_t>;

/// One that says that light is brighter by the factor exp(offset), told to 2 %.
PatchReading reading(float offset, float rest) { return {Rgb(offset), Rgb(0.02f), Rgb(rest)}; }

TEST(KnownPatches, OneThatContradictsWhatIsKnownIsLeftOut) {
    EXPECT_EQ(consistentPatches({reading(0.8f, 0.05f)}), Used{0});
    EXPECT_EQ(consistentPatches({reading(0.1f, 0.05f)}), Used{1});
    // Off in one channel alone: another white balance.
    PatchReading tinted = reading(0, 0.05f);
    tinted.offset.z = -0.5f;
    EXPECT_EQ(consistentPatches({tinted}), Used{0});
    EXPECT_TRUE(consistentPatches({}).empty());
}

TEST(KnownPatches, WhereNothingElseIsKnownTheyAreBelieved) {
    EXPECT_EQ(consistentPatches({reading(0.8f, 10)}), Used{1});
    // Nothing says which of two is wrong.
    EXPECT_EQ(consistentPatches({reading(0.8f, 10), reading(0, 10)}), Used({1, 1}));
}

TEST(KnownPatches, TheOneThatTheOthersContradictIsLeftOut) {
    EXPECT_EQ(consistentPatches({reading(1.1f, 10), reading(0.8f, 10), reading(1.11f, 10)}), Used({1, 0, 1}));
    // What is known poorly decides between two.
    EXPECT_EQ(consistentPatches({reading(0.1f, 0.25f), reading(-0.6f, 0.25f)}), Used({1, 0}));
    // Good ones that wrong ones drew along come back.
    EXPECT_EQ(consistentPatches({reading(0, 10), reading(0.01f, 10), reading(-0.01f, 10), reading(2, 10),
                                 reading(-1.3f, 10), reading(0.02f, 10)}),
              Used({1, 1, 1, 0, 0, 1}));
}

TEST(KnownPatches, TheScaleIsTheirMeanByTheirDeviations) {
    EXPECT_NEAR(offsetOfPatches({reading(0.3f, 10)}, {1}).y, 0.3f, 1e-4f);
    EXPECT_NEAR(offsetOfPatches({reading(0.3f, 0.02f)}, {1}).y, 0.15f, 1e-4f);
    EXPECT_NEAR(offsetOfPatches({reading(0.3f, 10), reading(0.1f, 10), reading(3, 10)}, {1, 1, 0}).y, 0.2f, 1e-4f);
    EXPECT_EQ(offsetOfPatches({reading(0.3f, 10)}, {0}), Rgb(0));
}

}  // namespace
}  // namespace relamp
