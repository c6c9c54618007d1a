#include "solve/gloss/gloss.h"

#include <gtest/gtest.h>

#include "tests/solve/glazed_ball.h"

namespace relamp {
namespace {

TEST(FitGloss, FirstGlanceLosesNoLobe) {
    const test::CoatedBall ball;
    Progress progress;
    GlossOptions options;
    ComponentGloss found[2];
    for (const bool screen : {false, true}) {
        options.screen = screen;
        found[screen] = fitGloss(ball.capture, ball.scene, ball.samples, {}, {}, ball.lighting, builtInBasis(), 0,
                                 options, progress);
        ASSERT_TRUE(found[screen].lobe) << screen;
    }
    EXPECT_EQ(found[1].lobe->kind, Lobe::Kind::ggxDielectric);
    EXPECT_TRUE(found[1].matte);
    // Roughness is sought with other directions: it may end one step of the ladder beside.
    EXPECT_NEAR(std::sqrt(found[1].lobe->alpha / found[0].lobe->alpha), 1, 0.08f);
    EXPECT_NEAR(found[1].weight.y / found[0].weight.y, 1, 0.05f);
    // The coating that was painted: roughness 0.22, weight 1.
    EXPECT_NEAR(std::sqrt(found[1].lobe->alpha), std::sqrt(ball.gloss.lobe->alpha), 0.05f);
    EXPECT_NEAR(found[1].weight.y, 1, 0.15f);
}

TEST(FitGloss, AMatteBallHasNone) {
    test::CoatedBall ball;
    for (size_t v = 0; v + 1 < ball.samples.start.size(); ++v)
        for (uint32_t s = ball.samples.start[v]; s < ball.samples.start[v + 1]; ++s)
            ball.samples.samples[s].radiance = ball.matte[v];
    Progress progress;
    for (const bool screen : {false, true}) {
        GlossOptions options;
        options.screen = screen;
        EXPECT_FALSE(fitGloss(ball.capture, ball.scene, ball.samples, {}, {}, ball.lighting, builtInBasis(), 0, options,
                              progress)
                         .lobe)
            << screen;
    }
}

}  // namespace
}  // namespace relamp
