// Cameras as lines in space.
#include "viewport/space_lines.h"

#include <gtest/gtest.h>

#include "support/estimates.h"

namespace relamp::ui {
namespace {

TEST(Frustum, IsNotShownToAnEyeThatStandsInIt) {
    const Camera camera = test::cameraAt({2, 0, 1}, {0, 0, 0}, 80, 60, 80);
    const float depth = frustumDepth(2);
    EXPECT_FALSE(frustumShown(camera, {2, 0, 1}, depth));
    const Vec3 behind = Vec3(2, 0, 1) - 0.5f * depth * Vec3(camera.forward());
    EXPECT_FALSE(frustumShown(camera, behind, depth));
    EXPECT_TRUE(frustumShown(camera, {2, 1, 1}, depth));
    EXPECT_TRUE(frustumShown(camera, {-2, 0, 1}, depth));
}

}  // namespace
}  // namespace relamp::ui
