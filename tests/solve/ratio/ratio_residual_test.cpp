#include "solve/ratio/ratio_residual.h"

#include <gtest/gtest.h>

#include <limits>

#include "solve/ratio/influence_rows.h"
#include "solve/ratio/pair_gram.h"

namespace relamp {
namespace {

TEST(RatioResidual, IsTheDifferenceOfLogAlbedoWhereThatIsSmall) {
    // Albedos 0.5 and 0.51 under the irradiances 3 and 7.
    EXPECT_NEAR(RatioResidual::value(0.5 * 3, 0.51 * 7, 3, 7), std::log(0.5 / 0.51), 1e-6);
    EXPECT_EQ(RatioResidual::value(0.5 * 3, 0.5 * 7, 3, 7), 0);
}

TEST(RatioResidual, StaysFiniteInTheDark) {
    EXPECT_EQ(RatioResidual::value(0, 0, 0, 0), 0);
    EXPECT_EQ(RatioResidual::value(1, 1, 0, 2), 2);
    EXPECT_TRUE(std::isfinite(RatioResidual::at(0, 1, 0, 0).byB));
}

TEST(RatioResidual, HasTheDerivativesOfFiniteDifferences) {
    const double ya = 0.7, yb = 1.9, la = 1.3, lb = 2.1, h = 1e-6;
    const RatioResidual r = RatioResidual::at(ya, yb, la, lb);
    EXPECT_EQ(r.residual, RatioResidual::value(ya, yb, la, lb));
    EXPECT_NEAR((RatioResidual::value(ya, yb, la + h, lb) - RatioResidual::value(ya, yb, la - h, lb)) / (2 * h), -r.byA,
                1e-8);
    EXPECT_NEAR((RatioResidual::value(ya, yb, la, lb + h) - RatioResidual::value(ya, yb, la, lb - h)) / (2 * h), r.byB,
                1e-8);
}

TEST(RatioResidual, HasTheVarianceOfSmallErrors) {
    // r = log p - log q to first order about p = q, so its variance is that of both relative errors.
    const double ya = 2, yb = 4, la = 1, lb = 2;  // p = q = 4
    EXPECT_NEAR(RatioResidual::variance(ya, yb, la, lb, 0.04, 0.08), 0.01 * 0.01 + 0.02 * 0.02, 1e-12);
}

TEST(CauchyLoss, IsTheSquareWhereThatIsSmallAndItsWeightIsItsSlope) {
    const CauchyLoss cauchy{2.5};
    EXPECT_NEAR(cauchy.loss(1e-4), 1e-4, 1e-8);
    for (const double squared : {0.1, 3.0, 80.0})
        EXPECT_NEAR((cauchy.loss(squared + 1e-5) - cauchy.loss(squared - 1e-5)) / 2e-5, cauchy.weight(squared), 1e-6);
    EXPECT_EQ(cauchy.loss(3, 0.25), 0.25 * cauchy.loss(3));
}

TEST(InfluenceRows, OfTwoMatricesAreThoseOfOneThatHoldsBoth) {
    InfluenceMatrix both{9, 3, {}}, first{5, 3, {}}, second{4, 3, {}};
    for (size_t i = 0; i < 27; ++i) both.values.push_back(float(i) * 0.37f);
    first.values.assign(both.values.begin(), both.values.begin() + 15);
    second.values.assign(both.values.begin() + 15, both.values.end());
    const InfluenceRows rows(first, second);
    ASSERT_EQ(rows.rows, 9u);
    std::vector<float> scratch;
    for (size_t begin = 0; begin < 9; ++begin)
        for (size_t count = 1; begin + count <= 9; ++count) {
            const float* block = rows.block(begin, count, scratch);
            for (size_t i = 0; i < count * 3; ++i) EXPECT_EQ(block[i], both.row(begin)[i]);
        }
    for (size_t r = 0; r < 9; ++r) EXPECT_EQ(rows.row(r)[1], both.row(r)[1]);
}

TEST(InfluenceRows, GiveTheBitsOfOneMatrixInProducts) {
    InfluenceMatrix both{1300, 20, {}};
    for (size_t i = 0; i < 1300 * 20; ++i) both.values.push_back(float((i * 2654435761u) % 1000) / 1000);
    InfluenceMatrix first{700, 20, {both.values.begin(), both.values.begin() + 700 * 20}},
        second{600, 20, {both.values.begin() + 700 * 20, both.values.end()}};
    ChannelWeights weights;
    for (uint32_t i = 0; i <= 1300; ++i) weights.start.push_back(i);
    for (uint32_t i = 0; i < 1300; ++i) {
        weights.other.push_back(i);
        weights.weight.push_back({1, 2, 3, 0.5f, 0.25f, 0.125f});
    }
    Progress progress;
    EXPECT_EQ(channelGram(both, weights, false, progress),
              channelGram(InfluenceRows(first, second), weights, false, progress));
}

}  // namespace
}  // namespace relamp
