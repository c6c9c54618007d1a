#include "solve/gloss/one_lobe.h"

#include <gtest/gtest.h>

#include "tests/solve/small_problem.h"

namespace relamp {
namespace {

TEST(OneLobe, FindsLightAndStrengthTogetherFromAnEmitterSeenDirectly) {
    const test::SmallProblem p = test::smallProblem(600);
    const Rgb strength(0.9f, 0.7f, 0.4f);
    std::vector<GlossyObservation> observations(p.influence.rows);
    for (size_t r = 0; r < observations.size(); ++r) {
        observations[r].radiance = p.matte.radiance[r] / p.albedo[r] * strength;
        observations[r].sigma = 0.01f * observations[r].radiance.y + 1e-4f;
    }
    Progress progress;
    const OneLobeFit fit = fitOneLobe(p.influence, observations, p.anchors, p.start, progress);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(fit.weight[c], strength[c], 0.03f * strength[c]) << c;
    EXPECT_LT(test::litDifference(p, fit.lighting, p.truth), 0.03);
    EXPECT_LT(fit.residual, 1);
}

TEST(OneLobe, StaysFiniteWhenNothingIsSeenDirectly) {
    test::SmallProblem p = test::smallProblem(200);
    p.anchors.emitterClipped[0] = 1;
    std::vector<GlossyObservation> observations(p.influence.rows);
    for (size_t r = 0; r < observations.size(); ++r) {
        observations[r].radiance = p.matte.radiance[r];
        observations[r].sigma = 0.02f * observations[r].radiance.y + 1e-4f;
    }
    Progress progress;
    const OneLobeFit fit = fitOneLobe(p.influence, observations, p.anchors, p.start, progress);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(fit.weight[c], 0.7f, 0.01f);
    for (const Rgb& l : fit.lighting.leafRadiance) EXPECT_TRUE(isFinite(l));
}

}  // namespace
}  // namespace relamp
