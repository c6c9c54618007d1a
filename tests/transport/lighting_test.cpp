#include "transport/lighting.h"

#include <gtest/gtest.h>

#include <map>

#include "base/random.h"
#include "wavelet/haar.h"

namespace relamp {
namespace {

/// Leaves of mixed levels, split in a fixed pattern.
LightLeaves mixedLeaves() {
    LightLeaves leaves = LightLeaves::uniform(2);
    for (int i = 0; i < 60; ++i) leaves.split(mixBits(uint64_t(i)) % leaves.size());
    return leaves;
}

Vec3 someDirection(uint64_t i) {
    const float z = 2 * unitFloat(mixBits(2 * i)) - 1, p = 2 * pi * unitFloat(mixBits(2 * i + 1)),
                r = std::sqrt(1 - z * z);
    return {r * std::cos(p), r * std::sin(p), z};
}

double totalSolidAngle(const LightLeaves& leaves) {
    double sum = 0;
    for (size_t i = 0; i < leaves.size(); ++i) sum += leaves[i].solidAngle();
    return sum;
}

TEST(LightLeaves, CoverTheSphereOnceWhateverIsSplit) {
    for (const int level : {0, 3, 5}) {
        EXPECT_EQ(LightLeaves::uniform(level).size(), size_t(1) << (2 * level));
        EXPECT_NEAR(totalSolidAngle(LightLeaves::uniform(level)), 4 * piD, 1e-4);
    }
    const LightLeaves leaves = mixedLeaves();
    EXPECT_EQ((leaves.size() - 16) % 3, 0u);
    EXPECT_GT(leaves.size(), 150u);
    EXPECT_NEAR(totalSolidAngle(leaves), 4 * piD, 1e-4);
}

TEST(LightLeaves, FindTheLeafThatHoldsADirection) {
    const LightLeaves leaves = mixedLeaves();
    for (uint64_t i = 0; i < 5000; ++i) {
        const Vec3 d = someDirection(i);
        const Leaf& leaf = leaves[leaves.leafOf(d)];
        const Vec2 p = sphereToSquare(d) * float(1 << leaf.level);
        // Rounding may put a direction on an edge next door.
        EXPECT_NEAR(p.x, leaf.x + 0.5f, 0.5f + 1e-3f);
        EXPECT_NEAR(p.y, leaf.y + 0.5f, 0.5f + 1e-3f);
    }
    for (size_t i = 0; i < leaves.size(); ++i) EXPECT_EQ(leaves.leafOf(leaves.direction(i, Vec2(0.5f))), i);
}

TEST(LightLeaves, OfTwoEnvironmentsHaveTheirOwnQuadtreesAndNeverMeet) {
    LightLeaves leaves = LightLeaves::uniform(2, Mat3(1), {0, -1, 1, 0});
    ASSERT_EQ(leaves.size(), 32u);
    ASSERT_EQ(leaves.environments(), 2u);
    leaves.split(20);
    const LightLeaves alone = LightLeaves::uniform(2);
    for (uint64_t i = 0; i < 500; ++i) {
        const Vec3 d = someDirection(i);
        EXPECT_EQ(leaves.leafOf(d), alone.leafOf(d)) << "the first one was not split";
        const Leaf& other = leaves[leaves.leafOf(d, 1)];
        EXPECT_EQ(other.environment, 1);
        EXPECT_EQ(other.level, alone.leafOf(d) == 4 ? 3 : 2);
    }
    for (const auto& [a, b] : leaves.neighbourPairs()) EXPECT_EQ(leaves[a].environment, leaves[b].environment);
    EXPECT_TRUE(leaves.shines(3, 0) && leaves.shines(3, 3) && leaves.shines(20, 2));
    EXPECT_FALSE(leaves.shines(3, 1) || leaves.shines(20, 1) || leaves.shines(3, 2) || leaves.shines(20, 0));
    std::vector<Leaf> list;
    for (size_t i = 0; i < leaves.size(); ++i) list.push_back(leaves[i]);
    EXPECT_EQ(LightLeaves::of(list, Mat3(1), {0, 1}).leafOf(someDirection(7), 1), leaves.leafOf(someDirection(7), 1));
    EXPECT_THROW(LightLeaves::of(list), Error) << "there is no second one";
    list[0].environment = 1;
    EXPECT_THROW(LightLeaves::of(list, Mat3(1), {0, 1}), Error);
}

TEST(LightLeaves, OfAPlanAreTakenOverForStatesOfWhichSomeHaveNoEnvironment) {
    LightLeaves plan = LightLeaves::uniform(1);
    plan.split(0);
    const LightLeaves leaves = plan.withStates({0, -1});
    ASSERT_EQ(leaves.size(), plan.size());
    EXPECT_TRUE(leaves.shines(5, 0));
    EXPECT_FALSE(leaves.shines(5, 1));
    EXPECT_THROW(plan.withStates({0, 1}), Error);
}

TEST(LightLeaves, SplitKeepsTheOtherLeavesAndPutsTheFirstChildInPlace) {
    LightLeaves leaves = LightLeaves::uniform(1);
    leaves.split(2);
    ASSERT_EQ(leaves.size(), 7u);
    EXPECT_EQ(leaves[2].level, 2);
    EXPECT_EQ(leaves[2].x, 0);
    EXPECT_EQ(leaves[2].y, 2);
    for (const size_t i : {0u, 1u, 3u}) EXPECT_EQ(leaves[i].level, 1);
    for (const size_t i : {4u, 5u, 6u}) EXPECT_EQ(leaves[i].level, 2);
}

TEST(LightLeaves, AreNotSplitBelowTheFinestLevel) {
    LightLeaves leaves = LightLeaves::uniform(0);
    for (int i = 0; i < LightLeaves::maxLevel + 3; ++i) leaves.split(0);
    EXPECT_EQ(leaves[0].level, LightLeaves::maxLevel);
    EXPECT_EQ(leaves.size(), size_t(1 + 3 * LightLeaves::maxLevel));
    EXPECT_NEAR(totalSolidAngle(leaves), 4 * piD, 1e-4);
}

TEST(LightLeaves, NeighboursAreCloseOnTheSphereAndEachLeafHasSome) {
    const LightLeaves leaves = LightLeaves::uniform(4);
    std::map<uint32_t, int> count;
    for (const auto& [a, b] : leaves.neighbourPairs()) {
        EXPECT_LT(a, b);
        ++count[a];
        ++count[b];
        EXPECT_GT(glm::dot(leaves.direction(a, Vec2(0.5f)), leaves.direction(b, Vec2(0.5f))), 0.85f) << a << " " << b;
    }
    EXPECT_EQ(count.size(), leaves.size());
    for (const auto& [leaf, neighbours] : count) EXPECT_GE(neighbours, 3) << leaf;
}

TEST(LightLeaves, OfCellsAgreesWithTheLeafOfTheirCentres) {
    const LightLeaves leaves = mixedLeaves();
    for (const int side : {64, 256}) {
        const DirectionGrid grid{side};
        const std::vector<uint32_t> leafOfCell = leaves.leafOfCells(grid);
        for (int c = 0; c < grid.cells(); ++c) {
            const Leaf& leaf = leaves[leafOfCell[size_t(c)]];
            const Vec2 centre = (Vec2(float(c % side), float(c / side)) + 0.5f) / float(side) * float(1 << leaf.level);
            ASSERT_TRUE(int(centre.x) == leaf.x && int(centre.y) == leaf.y) << c;
        }
    }
}

TEST(EnvironmentCoefs, OfAConstantAreOneCoefficient) {
    for (const LightLeaves& leaves : {LightLeaves::uniform(4), mixedLeaves()}) {
        Lighting lighting{leaves, std::vector<Rgb>(leaves.size(), Rgb(2, 3, 0)), {}};
        const auto coefs = environmentCoefs(lighting, 32);
        // The scaling function is 1 / sqrt(4 pi).
        for (int channel = 0; channel < 2; ++channel) {
            double rest = 0;
            ASSERT_GE(coefs[size_t(channel)].size(), 1u);
            EXPECT_EQ(coefs[size_t(channel)].index[0], 0u);
            EXPECT_NEAR(coefs[size_t(channel)].value[0], (channel ? 3 : 2) * std::sqrt(4 * piD), 1e-4);
            for (size_t i = 1; i < coefs[size_t(channel)].size(); ++i)
                rest = std::max(rest, double(std::abs(coefs[size_t(channel)].value[i])));
            EXPECT_LT(rest, 1e-5);
        }
        EXPECT_EQ(coefs[2].size(), 0u);
    }
}

TEST(EnvironmentCoefs, OfUniformLeavesAreOneForEachLeaf) {
    Lighting lighting{LightLeaves::uniform(3), {}, {}};
    for (size_t i = 0; i < lighting.leaves.size(); ++i)
        lighting.leafRadiance.push_back(Rgb(unitFloat(mixBits(i)), 1, 0));
    const auto coefs = environmentCoefs(lighting, 64);
    EXPECT_LE(coefs[0].size(), 64u);
    EXPECT_GT(coefs[0].size(), 50u);
}

TEST(EnvironmentCoefs, AverageLeavesFinerThanTheGridAndKeepTheirEnergy) {
    LightLeaves leaves = LightLeaves::uniform(0);
    for (int i = 0; i < 7; ++i) leaves.split(0);
    Lighting lighting{leaves, std::vector<Rgb>(leaves.size(), Rgb(0)), {}};
    lighting.leafRadiance[0] = Rgb(1000);  // one cell of a square of side 128
    const auto coefs = environmentCoefs(lighting, 16);
    std::vector<float> cells(256);
    scatter(coefs[0], cells);
    EXPECT_NEAR(cells[0] * std::sqrt(4 * piD), 1000 * leaves[0].solidAngle(), 1e-3) << "mean radiance times 4 pi";
    haarInverse(cells, 16);
    const DirectionGrid grid{16};
    EXPECT_NEAR(cells[0] / std::sqrt(grid.cellSolidAngle()), 1000.0 / 64, 1e-3);
    EXPECT_NEAR(cells[1], 0, 1e-4);
}

}  // namespace
}  // namespace relamp
