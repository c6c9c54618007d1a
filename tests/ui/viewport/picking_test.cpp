#include "viewport/picking.h"

#include <gtest/gtest.h>

#include "viewport/photograph.h"

namespace relamp::ui {
namespace {

/// Two squares above each other, facing up, at heights 0 and 1.
Mesh twoFloors() {
    Mesh mesh;
    for (float z : {0.0f, 1.0f}) {
        const uint32_t first = uint32_t(mesh.positions.size());
        for (const Vec2& p : {Vec2(0, 0), Vec2(1, 0), Vec2(1, 1), Vec2(0, 1)}) mesh.positions.push_back({p.x, p.y, z});
        mesh.triangles.push_back({first, first + 1, first + 2});
        mesh.triangles.push_back({first, first + 2, first + 3});
    }
    mesh.normals.assign(mesh.positions.size(), {0, 0, 1});
    return mesh;
}

TEST(Picking, TakesTheNearestSurfaceWithItsNearestCorner) {
    const Mesh mesh = twoFloors();
    const Ray down{{0.9f, 0.2f, 5}, {0, 0, -1}};
    const auto point = pickSurface(mesh, down);
    ASSERT_TRUE(point);
    EXPECT_EQ(point->triangle, 2u);
    EXPECT_EQ(point->vertex, 5u);
    EXPECT_NEAR(glm::distance(point->position, Vec3(0.9f, 0.2f, 1)), 0, 1e-5f);
    EXPECT_NEAR(point->normal.z, 1, 1e-6f);
    const Triangle& t = mesh.triangles[point->triangle];
    const Vec3 again = (1 - point->barycentric.x - point->barycentric.y) * mesh.positions[t[0]] +
                       point->barycentric.x * mesh.positions[t[1]] + point->barycentric.y * mesh.positions[t[2]];
    EXPECT_NEAR(glm::distance(again, point->position), 0, 1e-5f);
    EXPECT_FALSE(pickSurface(mesh, {{2, 2, 5}, {0, 0, -1}}));
}

TEST(Picking, RadianceIsLinearBetweenTheVertices) {
    LiveFrame frame;
    frame.mesh = std::make_shared<const Mesh>(twoFloors());
    for (const Vec3& p : frame.mesh->positions) frame.radiance.push_back(Rgb(p.x, 2 * p.y, p.z));
    const auto value = radianceAlong(frame, {{0.6f, 0.3f, 5}, {0, 0, -1}});
    ASSERT_TRUE(value);
    EXPECT_LT(glm::distance(*value, Rgb(0.6f, 0.6f, 1)), 1e-5f);
    EXPECT_FALSE(radianceAlong(frame, {{2, 2, 5}, {0, 0, -1}}));
}

TEST(Picking, HiddenComponentsLetTheRayThrough) {
    Progress progress;
    const Scene scene = buildScene(twoFloors(), progress);
    ASSERT_EQ(scene.components, 2u);
    EXPECT_TRUE(visibleTriangles(scene.mesh, nullptr, scene, {}).empty());
    const auto visible = visibleTriangles(scene.mesh, nullptr, scene, {scene.component[4]});
    EXPECT_EQ(visible, (std::vector<uint8_t>{1, 1, 0, 0}));
    EXPECT_EQ(pickSurface(scene.mesh, {{0.5f, 0.2f, 5}, {0, 0, -1}}, visible)->triangle, 0u);
}

TEST(Picking, CopiesAreHiddenWithWhatTheyWereCopiedFromAndAddedShapesStay) {
    Progress progress;
    const Scene scene = buildScene(twoFloors(), progress);
    Mesh live = scene.mesh;
    live.triangles.push_back({8, 9, 10});
    live.triangles.push_back({11, 12, 13});
    for (int i = 0; i < 6; ++i) live.positions.push_back({float(i), 0, 3}), live.normals.push_back({0, 0, 1});
    const std::vector<uint32_t> origin{0, 1, 2, 3, 4, 5, 6, 7, 4, 5, 6, ~0u, ~0u, ~0u};
    EXPECT_EQ(visibleTriangles(live, &origin, scene, {scene.component[4]}), (std::vector<uint8_t>{1, 1, 0, 0, 0, 1}));
}

TEST(Photograph, IsLaidStraightForADistortedLens) {
    // An image whose red channel is the undistorted x of each pixel's ray: laid straight it must be a ramp.
    View view;
    view.camera.width = 200, view.camera.height = 150;
    view.camera.focalX = view.camera.focalY = 180, view.camera.centreX = 100, view.camera.centreY = 75;
    view.camera.model = LensModel::simpleRadial;
    view.camera.distortion[0] = -0.15;
    view.image = Image(200, 150);
    for (int y = 0; y < 150; ++y)
        for (int x = 0; x < 200; ++x) {
            const Vec3 d = view.camera.rayDirection({float(x) + 0.5f, float(y) + 0.5f});
            view.image.at(x, y) = Rgb(1 + d.x / -d.z, 1, 1);
        }
    int width = 0, height = 0;
    const auto straight = straightened(view, 2048, width, height);
    ASSERT_EQ(width, 200);
    ASSERT_EQ(height, 150);
    for (int y = 30; y < 120; y += 15)
        for (int x = 40; x < 160; x += 20)
            EXPECT_NEAR(straight[size_t(y) * 200 + size_t(x)].x, 1 + (float(x) + 0.5f - 100) / 180, 2e-3f)
                << x << " " << y;
}

}  // namespace
}  // namespace relamp::ui
