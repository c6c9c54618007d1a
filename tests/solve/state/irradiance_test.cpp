#include "solve/state/irradiance.h"

#include <gtest/gtest.h>

#include "solve/small_problem.h"

namespace relamp {
namespace {

TEST(Irradiance, IsRowsTimesLightAndWhatOtherSurfacesSend) {
    const test::SmallProblem p = test::smallProblem(40);
    const std::vector<Rgb> bounce(40, Rgb(0.5f, 1, 2));
    const Irradiance direct = irradianceOf(p.influence, p.truth, {}, {}),
                     all = irradianceOf(p.influence, p.truth, bounce, {});
    for (size_t i = 0; i < 40; ++i) {
        EXPECT_EQ(direct.value[i], lightOfRow(p.influence.row(i), p.truth));
        EXPECT_EQ(all.value[i], direct.value[i] + bounce[i]);
        EXPECT_FLOAT_EQ(direct.sigma[i].x, 0.01f * direct.value[i].x);
    }
}

TEST(Irradiance, IsUnsureByAQuarterOfTheStepToANeighbour) {
    const test::SmallProblem p = test::smallProblem(20);
    const Irradiance alone = irradianceOf(p.influence, p.truth, {}, {}),
                     paired = irradianceOf(p.influence, p.truth, {}, {{3, 7, 0.3f, true}, {4, 8, 1.0f}});
    const float step = 0.25f * std::abs(alone.value[3].x - alone.value[7].x);
    EXPECT_NEAR(paired.sigma[3].x, std::hypot(step, 0.01f * alone.value[3].x), 1e-6f);
    EXPECT_EQ(paired.sigma[4], alone.sigma[4]) << "only mesh neighbours share an edge";
}

TEST(Irradiance, ThatIsTrueLeavesPairsOfOneAlbedoWithoutMismatch) {
    const test::SmallProblem p = test::smallProblem();
    EXPECT_LT(pairMismatch(p.matte, p.pairs, irradianceOf(p.influence, p.truth, {}, p.pairs)), 1e-5);
    EXPECT_GT(pairMismatch(p.matte, p.pairs, irradianceOf(p.influence, p.start, {}, p.pairs)), 0.02);
}

TEST(Irradiance, TellsTheFractionThatBounced) {
    const test::SmallProblem p = test::smallProblem(40);
    const Irradiance direct = irradianceOf(p.influence, p.truth, {}, {});
    EXPECT_EQ(bouncedFractionOf({}, direct), 0);
    const Irradiance doubled = irradianceOf(p.influence, p.truth, direct.value, {});
    EXPECT_NEAR(bouncedFractionOf(direct.value, doubled), 0.5, 1e-6);
}

}  // namespace
}  // namespace relamp
