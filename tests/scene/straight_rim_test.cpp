// Rims of flat surfaces with crooked ends.
#include "scene/straight_rim.h"

#include <gtest/gtest.h>

#include "base/random.h"
#include "support/shapes.h"

namespace relamp {
namespace {

/// A sheet without the triangles that `goes` says.
template <class Goes>
Mesh without(Mesh mesh, const Goes& goes) {
    size_t number = 0;
    std::erase_if(mesh.triangles, [&](const Triangle& t) {
        return goes((mesh.positions[t[0]] + mesh.positions[t[1]] + mesh.positions[t[2]]) / 3.0f, number++);
    });
    return mesh;
}

std::vector<StraightRim> rimsOf(const Mesh& mesh) {
    return straightRims(test::sceneOf(mesh), std::vector<uint8_t>(mesh.vertexCount(), 0));
}

TEST(StraightRim, CrookedEdgesOfATableAreFourLines) {
    // 1.2 m x 0.8 m, cut crookedly out of a larger sheet, a vase's hole in it.
    const Mesh mesh = without(test::sheet({-0.8f, -0.6f, 0.3f}, {1.6f, 0, 0}, {0, 1.2f, 0}, 160, 120),
                              [](const Vec3& p, size_t number) {
                                  const float crooked = 0.012f * (unitFloat(mixBits(number)) - 0.5f);
                                  return std::abs(p.x) > 0.6f + crooked || std::abs(p.y) > 0.4f + crooked ||
                                         glm::length(p - Vec3(0.1f, 0.1f, 0.3f)) < 0.1f;
                              });
    EXPECT_TRUE(straightRims(test::sceneOf(mesh), std::vector<uint8_t>(mesh.vertexCount(), 1)).empty()) << "a light";
    std::vector<StraightRim> rims = rimsOf(mesh);
    ASSERT_EQ(rims.size(), 4u);
    joinCorners(rims, 0.08);
    for (const StraightRim& rim : rims) {
        EXPECT_TRUE(rim.cornerFrom && rim.cornerTo);
        for (const DVec3& end : {rim.from, rim.to}) {
            EXPECT_NEAR(std::abs(end.x), 0.6, 0.006);
            EXPECT_NEAR(std::abs(end.y), 0.4, 0.006);
            EXPECT_NEAR(end.z, 0.3, 1e-5);
        }
        EXPECT_NEAR(rim.up.z, 1, 1e-6);
        EXPECT_GT(glm::dot(rim.out(), 0.5 * (rim.from + rim.to) - DVec3(0, 0, 0.3)), 0.3) << "away from the table";
        EXPECT_NEAR(rim.beyond({0, 0, 0.3}), std::abs(rim.along().x) > 0.5 ? -0.4 : -0.6, 0.008);
    }
}

TEST(StraightRim, BoxesHaveCreasesAndBallsNothing) {
    const std::vector<StraightRim> rims = rimsOf(test::box({-0.5f, -0.5f, 0}, {0.5f, 0.5f, 0.4f}, 40));
    EXPECT_TRUE(rims.empty()) << "sheets without common vertices: each ends, but others go on there";
    EXPECT_TRUE(rimsOf(test::ball({0, 0, 0}, 0.5f, 40, 80)).empty());
}

TEST(StraightRim, WhereASideFallsAwayTheEdgeIsCreased) {
    // A sheet bent down along x = 0.3.
    Mesh mesh = test::sheet({-0.5f, -0.4f, 0}, {1, 0, 0}, {0, 0.8f, 0}, 100, 80);
    for (size_t v = 0; v < mesh.positions.size(); ++v) {
        Vec3& p = mesh.positions[v];
        if (p.x < 0.301f) continue;
        p = {0.3f, p.y, 0.3f - p.x};
        mesh.normals[v] = {1, 0, 0};
    }
    size_t creased = 0;
    for (const StraightRim& rim : rimsOf(mesh)) {
        const bool bend = std::abs(rim.from.x - 0.3) < 0.01 && std::abs(rim.to.x - 0.3) < 0.01 && rim.from.z > -0.01 &&
                          rim.to.z > -0.01;
        EXPECT_EQ(rim.creased, bend);
        if (!bend) continue;
        ++creased;
        EXPECT_NEAR(rim.length(), 0.8, 0.02);
    }
    EXPECT_EQ(creased, 2u) << "one of either side";
}

}  // namespace
}  // namespace relamp
