#include "pipeline/find_materials.h"

#include <gtest/gtest.h>

#include "tests/solve/glazed_ball.h"

namespace relamp {
namespace {

bool hasCoating(const Vec3& p) { return p.z > 0.25f; }

/// Photographs that show the whole sky behind it.
test::CoatedBall ballBeforeItsSky(int rings, const std::function<bool(const Vec3&)>& coated) {
    test::CoatedBall ball(rings, coated, 128);
    const DirectionGrid& grid = ball.samples.backgroundGrid;
    for (int c = 0; c < grid.cells(); ++c)
        ball.samples.background.push_back(ball.lighting.leafRadiance[ball.lighting.leaves.leafOf(grid.direction(c))]);
    ball.samples.backgroundPixels.assign(ball.samples.background.size(), 9);
    ball.samples.backgroundClipped.assign(ball.samples.background.size(), 0);
    return ball;
}

TEST(FindMaterials, TheCoatedPartOfABallGetsALobeOfItsOwn) {
    const test::CoatedBall ball = ballBeforeItsSky(60, hasCoating);
    EmitterClusters none;
    indexEmitters(ball.scene, none);
    Progress progress;
    const auto scene = findMaterials(ball.capture, ball.scene, ball.samples, none, false, {}, progress);
    ASSERT_TRUE(scene);
    ASSERT_EQ(scene->materials, ball.scene.components + 1);
    const uint32_t part = scene->materials - 1;
    EXPECT_TRUE(scene->shines[part]);
    size_t right = 0;
    for (uint32_t v = 0; v < scene->material.size(); ++v)
        right += (scene->material[v] == part) == hasCoating(scene->mesh.positions[v]);
    EXPECT_GT(double(right), 0.9 * double(scene->material.size()));
    const std::vector<uint8_t> skip(scene->material.size(), 0);
    EXPECT_EQ(matteObservations(*scene, ball.samples, skip).componentGlossy[part], 1);
    const ComponentGloss found =
        fitGloss(ball.capture, *scene, ball.samples, {}, {}, ball.lighting, builtInBasis(), part, {}, progress);
    ASSERT_TRUE(found.lobe);
    EXPECT_EQ(found.lobe->kind, Lobe::Kind::ggxDielectric);
    EXPECT_NEAR(found.weight.y, 1, 0.2f);
}

TEST(FindMaterials, AMatteSceneStaysAsItIs) {
    const test::CoatedBall ball(
        40, [](const Vec3&) { return false; }, 128);
    EmitterClusters none;
    indexEmitters(ball.scene, none);
    Progress progress;
    EXPECT_FALSE(findMaterials(ball.capture, ball.scene, ball.samples, none, false, {}, progress));
}

}  // namespace
}  // namespace relamp
