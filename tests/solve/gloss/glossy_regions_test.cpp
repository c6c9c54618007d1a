#include "solve/gloss/glossy_regions.h"

#include <gtest/gtest.h>

#include "base/random.h"
#include "tests/solve/glazed_ball.h"

namespace relamp {
namespace {

std::vector<GlossyRegion> regionsOf(const test::CoatedBall& ball, const GlossyRegionOptions& options = {}) {
    const std::vector<uint8_t> skip(ball.scene.mesh.vertexCount(), 0);
    MatteObservations matte;
    for (uint32_t v = 0; v < skip.size(); ++v) {
        matte.vertices.push_back(v);
        matte.radiance.push_back(ball.matte[v]);
    }
    Progress progress;
    return glossyRegions(ball.capture, ball.scene, ball.samples, {}, {}, matte, skip, ball.lighting, options, progress);
}

TEST(GlossyRegions, FindTheCoatedPartOfABall) {
    const auto hasCoating = [](const Vec3& p) { return p.z > 0.1f; };
    const test::CoatedBall ball(60, hasCoating, 128);
    const std::vector<GlossyRegion> regions = regionsOf(ball);
    ASSERT_EQ(regions.size(), 1u);
    size_t right = 0, all = 0;
    for (const uint32_t v : regions[0].vertices) right += hasCoating(ball.scene.mesh.positions[v]);
    for (const Vec3& p : ball.scene.mesh.positions) all += hasCoating(p);
    EXPECT_GT(double(right), 0.9 * double(all));
    EXPECT_GT(double(right), 0.9 * double(regions[0].vertices.size()));
    EXPECT_GT(regions[0].evidence, 100);
    EXPECT_FALSE(regions[0].whole);
}

TEST(GlossyRegions, AWhollyCoatedOrMatteBallHasNoParts) {
    const test::CoatedBall whole(40, {}, 128), matte(
                                                   40, [](const Vec3&) { return false; }, 128);
    const std::vector<GlossyRegion> regions = regionsOf(whole);
    ASSERT_EQ(regions.size(), 1u);
    EXPECT_TRUE(regions[0].whole);
    EXPECT_TRUE(regionsOf(matte).empty());
    const std::vector<uint8_t> skip(matte.scene.mesh.vertexCount(), 0);
    // Exact meshes of one material need no looking for parts.
    const test::CoatedBall half(
        40, [](const Vec3& p) { return p.z > 0.2f; }, 128);
    for (const bool exact : {false, true}) {
        EXPECT_FALSE(mayHaveParts(matte.scene, matte.samples, skip, exact));
        EXPECT_EQ(mayHaveParts(whole.scene, whole.samples, skip, exact), !exact);
        EXPECT_TRUE(mayHaveParts(half.scene, half.samples, skip, exact));
    }
}

TEST(GlossyRegions, WhatChangesNotAsALobeDoesIsNone) {
    // As texture on a mesh that is off does.
    test::CoatedBall ball(
        60, [](const Vec3&) { return false; }, 128);
    for (size_t i = 0; i < ball.samples.samples.size(); ++i) {
        RadianceSample& r = ball.samples.samples[i];
        r.radiance *= 1 + 0.4f * (unitFloat(mixBits(i)) - 0.5f);
    }
    EXPECT_TRUE(regionsOf(ball).empty());
}

TEST(GlossyRegions, WhatLooksLikeALobeByChanceIsNone) {
    // What looks like a lobe of positive weight here looks like one of negative weight there.
    test::CoatedBall ball(60, {}, 128);
    for (uint32_t v = 0; v < ball.scene.mesh.vertexCount(); ++v) {
        const Vec3 p = ball.scene.mesh.positions[v];
        if (std::sin(9 * p.x) * std::sin(9 * p.y) * std::sin(9 * p.z) > 0) continue;
        for (uint32_t s = ball.samples.start[v]; s < ball.samples.start[v + 1]; ++s) {
            Rgb& radiance = ball.samples.samples[s].radiance;
            radiance = 2.0f * ball.matte[v] - radiance;
        }
    }
    GlossyRegionOptions withoutChance;
    withoutChance.overChance = 0;
    EXPECT_FALSE(regionsOf(ball, withoutChance).empty());
    EXPECT_TRUE(regionsOf(ball).empty());
}

}  // namespace
}  // namespace relamp
