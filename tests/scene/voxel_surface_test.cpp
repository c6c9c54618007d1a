// Voxels and their surface.
#include "scene/voxel_surface.h"

#include <gtest/gtest.h>

#include <map>

#include "base/math.h"

namespace relamp {
namespace {

std::vector<Voxel> ballOf(int radius) {
    std::vector<Voxel> voxels;
    for (int x = -radius; x <= radius; ++x)
        for (int y = -radius; y <= radius; ++y)
            for (int z = -radius; z <= radius; ++z)
                if (x * x + y * y + z * z <= radius * radius) voxels.push_back({x, y, z});
    return voxels;
}

TEST(VoxelSurface, ABallHasItsRadiusVolumeAndAClosedSurface) {
    constexpr int radius = 12;
    constexpr float side = 0.01f;
    const Vec3 centre(1, 2, 3);
    const VoxelSurface surface = voxelSurface(ballOf(radius), centre, side, 0.5f);
    for (const Vec3& p : surface.positions) EXPECT_NEAR(glm::distance(p, centre), radius * side, side);
    double volume = 0;
    std::map<std::pair<uint32_t, uint32_t>, int> edges;
    for (const auto& [a, b, c] : surface.triangles) {
        const DVec3 p(surface.positions[a] - centre), q(surface.positions[b] - centre),
            r(surface.positions[c] - centre);
        volume += glm::dot(p, glm::cross(q, r)) / 6;
        for (const auto& [from, to] : {std::pair{a, b}, std::pair{b, c}, std::pair{c, a}}) ++edges[{from, to}];
    }
    const double truth = double(ballOf(radius).size()) * std::pow(double(side), 3);
    EXPECT_NEAR(volume, truth, 0.03 * truth);  // positive: counter-clockwise from outside
    for (const auto& [edge, count] : edges) {
        ASSERT_EQ(count, 1);
        ASSERT_TRUE(edges.contains({edge.second, edge.first}));
    }
}

TEST(VoxelSurface, VoxelsThatTouchAtACornerAreOneGroup) {
    const auto groups = touchingVoxels({{0, 0, 0}, {1, 1, 1}, {3, 1, 1}, {3, 2, 1}, {9, 9, 9}});
    ASSERT_EQ(groups.size(), 3u);
    EXPECT_EQ(groups[0].size(), 2u);
    EXPECT_EQ(groups[1], (std::vector<Voxel>{{3, 1, 1}, {3, 2, 1}}));
    EXPECT_EQ(groups[2].size(), 1u);
}

TEST(VoxelSurface, NothingOfNoVoxelsAndOfTooFarApartOnes) {
    EXPECT_TRUE(voxelSurface({}, Vec3(0), 1, 0.5f).positions.empty());
    EXPECT_TRUE(voxelSurface({{0, 0, 0}, {500, 500, 500}}, Vec3(0), 1, 0.5f).positions.empty());
}

}  // namespace
}  // namespace relamp
