#include "solve/chart.h"

#include <gtest/gtest.h>

#include "base/error.h"

namespace relamp {
namespace {

TEST(ChartPatches, LieInFourRowsOfSixBetweenTheCorners) {
    const std::vector<KnownPatch> patches = chartPatches(2, {Vec2(10, 20), Vec2(60, 20), Vec2(60, 50), Vec2(10, 50)});
    ASSERT_EQ(patches.size(), 24u);
    for (size_t k = 0; k < 24; ++k) {
        EXPECT_NEAR(patches[k].centre.x, 10 + 10 * float(k % 6), 1e-3f);
        EXPECT_NEAR(patches[k].centre.y, 20 + 10 * float(k / 6), 1e-3f);
        EXPECT_NEAR(patches[k].radius, 2.5f, 1e-3f);
        EXPECT_EQ(patches[k].view, 2u);
    }
    EXPECT_NEAR(luminance(patches[18].albedo), 0.90f, 0.01f);  // white
    EXPECT_NEAR(luminance(patches[21].albedo), 0.195f, 0.01f);
    EXPECT_NEAR(luminance(patches[23].albedo), 0.034f, 0.004f);  // black
    EXPECT_LT(patches[20].noise, patches[14].noise);             // greys are told better than colours
    EXPECT_GT(patches[14].albedo.x, 4 * patches[14].albedo.y);   // red
}

TEST(ChartPatches, FollowThePerspective) {
    // A plane seen aslant: x' = x / (1 + x), y' = y / (1 + x).
    const auto seen = [](float x, float y) { return Vec2(100 * x / (1 + x), 100 * y / (1 + x)); };
    const std::vector<KnownPatch> patches = chartPatches(0, {seen(0, 0), seen(1, 0), seen(1, 1), seen(0, 1)});
    for (size_t k = 0; k < 24; ++k) {
        const Vec2 truth = seen(float(k % 6) / 5, float(k / 6) / 3);
        EXPECT_LT(glm::distance(patches[k].centre, truth), 1e-3f) << k;
    }
    EXPECT_LT(patches[5].radius, patches[0].radius);
}

TEST(ChartPatches, CornersThatAreNoConvexShapeAreAnError) {
    EXPECT_THROW(chartPatches(0, {Vec2(0, 0), Vec2(60, 0), Vec2(0, 40), Vec2(60, 40)}), Error);  // crossed
    EXPECT_THROW(chartPatches(0, {Vec2(0, 0), Vec2(10, 0), Vec2(20, 0), Vec2(30, 0)}), Error);
    EXPECT_THROW(chartPatches(0, {Vec2(5, 5), Vec2(5, 5), Vec2(5, 5), Vec2(5, 5)}), Error);
}

}  // namespace
}  // namespace relamp
