// Order statistics and bounds: each rule of selection on even and odd counts, and without values.
#include "base/statistics.h"

#include <gtest/gtest.h>

#include "base/box.h"

namespace relamp {
namespace {

const std::vector<float> odd{5, 1, 3}, even{4, 1, 3, 2};

TEST(Statistics, MedianTakesTheUpperOfTwoMiddleValues) {
    EXPECT_EQ(medianOf(odd), 3);
    EXPECT_EQ(medianOf(even), 3);
    EXPECT_EQ(lowerMedianOf(odd), 3);
    EXPECT_EQ(lowerMedianOf(even), 2);
    EXPECT_EQ(meanMedianOf(odd), 3);
    EXPECT_EQ(meanMedianOf(even), 2.5f);
}

TEST(Statistics, QuantileRoundsTheRankDownAndNearestQuantileToTheNearest) {
    EXPECT_EQ(quantileOf(even, 0), 1);
    EXPECT_EQ(quantileOf(even, 0.6), 2);  // rank 1.8
    EXPECT_EQ(nearestQuantileOf(even, 0.6), 3);
    EXPECT_EQ(quantileOf(even, 1), 4);
    EXPECT_EQ(nearestQuantileOf(even, 1), 4);
}

TEST(Statistics, NoValuesGiveZero) {
    const std::vector<double> none;
    for (const double x :
         {medianOf(none), lowerMedianOf(none), meanMedianOf(none), quantileOf(none, 0.9), nearestQuantileOf(none, 0.9)})
        EXPECT_EQ(x, 0);
}

TEST(Statistics, SelectionReordersOnlyTheValuesItIsGiven) {
    std::vector<float> values = even;
    EXPECT_EQ(selectRank(values, 3), 4);
    EXPECT_EQ(values.back(), 4);
    std::sort(values.begin(), values.end());
    EXPECT_EQ(values, (std::vector<float>{1, 2, 3, 4}));
}

TEST(Box, GrowsAroundItsPoints) {
    Box box;
    EXPECT_TRUE(box.empty());
    EXPECT_FALSE(box.contains(Vec3(0)));
    box.grow(Vec3(1, 2, 3));
    EXPECT_FALSE(box.empty());
    EXPECT_EQ(box.diagonal(), 0);
    box.grow(Vec3(-2, 2, 7));
    EXPECT_EQ(box.min, Vec3(-2, 2, 3));
    EXPECT_EQ(box.max, Vec3(1, 2, 7));
    EXPECT_EQ(box.centre(), Vec3(-0.5f, 2, 5));
    EXPECT_EQ(box.size(), Vec3(3, 0, 4));
    EXPECT_EQ(box.diagonal(), 5);
    EXPECT_FALSE(box.contains(Vec3(0, 2.1f, 4)));
    box.widen(0.5f);
    EXPECT_TRUE(box.contains(Vec3(0, 2.1f, 4)));
}

TEST(Box, BoundsOfAList) {
    const DBox box = boxOf(std::vector<DVec3>{{0, 0, 1}, {1e9, -1, 0}});
    EXPECT_EQ(box.min, DVec3(0, -1, 0));
    EXPECT_EQ(box.max, DVec3(1e9, 0, 1));
}

}  // namespace
}  // namespace relamp
