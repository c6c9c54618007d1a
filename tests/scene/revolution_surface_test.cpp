// Cones and cylinders through points, and those that a mesh has.
#include "scene/revolution_surface.h"

#include <gtest/gtest.h>

#include "support/shapes.h"

namespace relamp {
namespace {

RevolutionSurface cone() {
    RevolutionSurface s;
    s.centre = {0.2, -0.1, 0.5};
    s.axis = glm::normalize(DVec3(0.3, -0.2, 1));
    s.across = glm::normalize(glm::cross(s.axis, DVec3(1, 0, 0)));
    s.radius = 0.1;
    s.slope = -0.6;
    return s;
}

/// Quads over heights and angles.
Mesh meshOf(const RevolutionSurface& s, double low, double high, int rows, int columns) {
    Mesh mesh;
    for (int row = 0; row <= rows; ++row)
        for (int column = 0; column < columns; ++column) {
            const double turn = 2 * piD * column / columns;
            mesh.positions.push_back(Vec3(s.at(low + (high - low) * row / rows, turn)));
            mesh.normals.push_back(Vec3(s.normal(turn)));
        }
    for (int row = 0; row < rows; ++row)
        for (int column = 0; column < columns; ++column) {
            const auto at = [&](int y, int x) { return uint32_t(y * columns + x % columns); };
            mesh.triangles.push_back({at(row, column), at(row, column + 1), at(row + 1, column + 1)});
            mesh.triangles.push_back({at(row, column), at(row + 1, column + 1), at(row + 1, column)});
        }
    return mesh;
}

TEST(RevolutionSurface, ThreePointsWithNormalsTellACone) {
    const RevolutionSurface truth = cone();
    std::vector<DVec3> at, normal;
    for (const auto& [h, turn] : {std::pair(0.0, 0.1), {0.08, 1.7}, {-0.05, 3.9}}) {
        at.push_back(truth.at(h, turn));
        normal.push_back(truth.normal(turn));
    }
    const auto found = fitRevolution(at, normal);
    ASSERT_TRUE(found);
    EXPECT_NEAR(std::abs(glm::dot(found->axis, truth.axis)), 1, 1e-9);
    for (const DVec3& p : {truth.at(0.05, 5.0), truth.at(-0.1, 2.0)}) EXPECT_NEAR(found->distance(p), 0, 1e-7);
    EXPECT_NEAR(found->distance(truth.at(0.02, 1.0) + 0.01 * truth.normal(1.0)), 0.01, 1e-7);
}

TEST(RevolutionSurface, APlaneAndABallTellNoAxis) {
    const std::vector<DVec3> at{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}};
    EXPECT_FALSE(fitRevolution(at, std::vector<DVec3>(4, DVec3(0, 0, 1))));
}

TEST(RevolutionSurface, ARayMeetsItWhereTheFormulaSays) {
    RevolutionSurface s;  // a cylinder about Z
    s.radius = 2;
    const auto meets = s.meets({-5, 0, 1}, {1, 0, 0});
    ASSERT_TRUE(meets);
    EXPECT_NEAR(meets->first, 3, 1e-12);
    EXPECT_NEAR(meets->second, 7, 1e-12);
    EXPECT_FALSE(s.meets({-5, 3, 1}, {1, 0, 0}));
    const RevolutionSurface c = cone();
    const DVec3 eye(2, 1, 0.6), direction = glm::normalize(c.at(0, 0.3) - eye);
    const auto through = c.meets(eye, direction);
    ASSERT_TRUE(through);
    for (const double t : {through->first, through->second}) EXPECT_NEAR(c.distance(eye + t * direction), 0, 1e-9);
}

TEST(RevolutionSurface, IsFoundInAMeshAboveAFloor) {
    const RevolutionSurface truth = cone();
    Mesh mesh = test::sheet({-0.6f, -0.6f, 0}, {1.2f, 0, 0}, {0, 1.2f, 0}, 60, 60);
    const size_t floor = mesh.vertexCount();
    test::append(mesh, meshOf(truth, -0.1, 0.1, 20, 60));
    const Scene scene = test::sceneOf(mesh);
    const std::vector<uint8_t> none(mesh.vertexCount(), 0);
    const auto found = findRevolution(scene, none, 0.0015f * scene.diagonal);
    ASSERT_TRUE(found);
    EXPECT_NEAR(found->high - found->low, 0.2, 0.003);
    EXPECT_GT(found->vertices.size(), (mesh.vertexCount() - floor) * 9 / 10);
    for (const uint32_t v : found->vertices) EXPECT_GE(v, floor);
    std::vector<uint8_t> taken = none;
    for (uint32_t v = uint32_t(floor); v < taken.size(); ++v) taken[v] = 1;
    EXPECT_FALSE(findRevolution(scene, taken, 0.0015f * scene.diagonal)) << "a floor is none";
}

}  // namespace
}  // namespace relamp
