#include "viewport/orbit_camera.h"

#include <gtest/gtest.h>

#include "viewport/eye_view.h"
#include "viewport/scene_extent.h"

namespace relamp::ui {
namespace {

constexpr float none = 1e-4f;

TEST(OrbitCamera, AzimuthZeroLooksAlongMinusX) {
    OrbitCamera camera;
    camera.target = {1, 2, 3};
    camera.distance = 2, camera.azimuth = 0, camera.elevation = 0;
    EXPECT_NEAR(glm::distance(camera.position(), Vec3(3, 2, 3)), 0, none);
    const Camera pinhole = camera.asCamera(640, 480);
    EXPECT_NEAR(glm::distance(pinhole.forward(), DVec3(-1, 0, 0)), 0, 1e-5);
    EXPECT_NEAR(pinhole.worldFromCamera[1].z, 1, 1e-5);  // up stays up
}

TEST(OrbitCamera, DraggingRightTurnsTheSceneRightAndDraggingDownLooksFromAbove) {
    OrbitCamera camera;
    const float azimuth = camera.azimuth, elevation = camera.elevation;
    camera.orbit({10, 5});
    EXPECT_LT(camera.azimuth, azimuth);
    EXPECT_GT(camera.elevation, elevation);
    camera.orbit({0, 1e6f});
    EXPECT_LT(camera.elevation, pi / 2);
}

TEST(OrbitCamera, PanningKeepsThePointUnderTheHand) {
    for (const bool orthographic : {false, true}) {
        OrbitCamera camera;
        camera.orthographic = orthographic;
        const Vec2 size(800, 600);
        const auto seenAt = [&] { return *eyeOf(camera, Vec2(0), size, Vec2(1), Vec3(0), 2).toScreen(Vec3(0)); };
        const Vec2 before = seenAt();
        camera.pan({30, -20}, size.y);
        EXPECT_NEAR(glm::distance(seenAt(), before + Vec2(30, -20)), 0, 0.6f) << orthographic;
    }
}

TEST(OrbitCamera, ZoomGoesThereAndBack) {
    OrbitCamera camera;
    const float distance = camera.distance;
    camera.zoom(3);
    EXPECT_LT(camera.distance, distance);
    camera.zoom(-3);
    EXPECT_NEAR(camera.distance, distance, 1e-5f);
}

TEST(OrbitCamera, FramedSphereAndBoxFillTheViewportButStayInside) {
    OrbitCamera camera;
    camera.frame({1, 1, 1}, 0.5f);
    const EyeView eye = eyeOf(camera, Vec2(0), Vec2(600, 600), Vec2(1), Vec3(1), 1);
    for (const Vec3& d : {eye.right, eye.up, -eye.right, -eye.up}) {
        const Vec2 at = *eye.toScreen(Vec3(1) + 0.5f * d);
        EXPECT_TRUE(eye.contains(at));
        EXPECT_GT(glm::distance(at, Vec2(300)), 240);
    }
    const Vec3 low(-3, -1, 0), high(3, 1, 0.5f);
    for (const float aspect : {0.5f, 1.0f, 2.5f})
        for (const bool orthographic : {false, true}) {
            camera.orthographic = orthographic;
            camera.frameBox(low, high, aspect);
            const EyeView framed = eyeOf(camera, Vec2(0), Vec2(400 * aspect, 400), Vec2(1), Vec3(0), 4);
            float nearest = 1e9f;
            for (int corner = 0; corner < 8; ++corner) {
                const auto at = framed.toScreen(
                    {corner & 1 ? high.x : low.x, corner & 2 ? high.y : low.y, corner & 4 ? high.z : low.z});
                ASSERT_TRUE(at && framed.contains(*at)) << aspect << " " << corner;
                nearest =
                    std::min({nearest, at->x / framed.size.x, 1 - at->x / framed.size.x, at->y / 400, 1 - at->y / 400});
            }
            EXPECT_LT(nearest, 0.06f) << aspect;
        }
}

TEST(OrbitCamera, TakesOverAPhotographsCameraAndGivesItBack) {
    OrbitCamera start;
    start.target = {0.3f, -0.2f, 0.5f}, start.azimuth = 2.4f, start.elevation = 0.7f, start.verticalFov = 0.9f;
    const Camera photograph = start.asCamera(640, 480);
    OrbitCamera camera;
    camera.matchCamera(photograph, start.distance);
    EXPECT_NEAR(glm::distance(camera.position(), start.position()), 0, none);
    EXPECT_NEAR(glm::distance(camera.target, start.target), 0, none);
    EXPECT_NEAR(camera.verticalFov, 0.9f, none);
    EXPECT_NEAR(glm::distance(camera.asCamera(640, 480).forward(), photograph.forward()), 0, none);
}

TEST(EyeView, ScreenAndRaysAgreeForBothProjections) {
    for (const bool orthographic : {false, true}) {
        OrbitCamera camera;
        camera.orthographic = orthographic;
        const EyeView eye = eyeOf(camera, {100, 50}, {640, 400}, Vec2(2), Vec3(0), 3);
        EXPECT_EQ(eye.width, 1280);
        EXPECT_EQ(eye.camera.height, 800);
        for (const Vec3& world : {Vec3(0), Vec3(0.4f, -0.3f, 0.2f), Vec3(-0.5f, 0.6f, 0.1f)}) {
            const Ray ray = eye.rayAt(*eye.toScreen(world));
            const Vec3 offset = world - ray.origin;
            EXPECT_NEAR(glm::length(glm::cross(offset, ray.direction)), 0, 2e-4f) << orthographic;
            EXPECT_GT(glm::dot(offset, ray.direction), 0);
            const Vec2 aside = *eye.toScreen(world + eye.right * eye.metresPerPoint(world) * 10.0f);
            EXPECT_NEAR(glm::distance(aside, *eye.toScreen(world)), 10, 0.01f);
        }
    }
}

TEST(EyeView, PhotographKeepsItsAspectAndItsProjection) {
    Camera camera;
    camera.width = 640, camera.height = 480, camera.focalX = 500, camera.focalY = 510, camera.centreX = 330,
    camera.centreY = 200;
    camera.worldFromCamera[3] = glm::dvec4(0, 0, 4, 1);
    const EyeView eye = eyeOf(camera, {10, 20}, {1000, 300}, Vec2(1), Vec3(0), 2);
    EXPECT_EQ(eye.width, 400);
    EXPECT_EQ(eye.height, 300);
    EXPECT_NEAR(eye.corner.x, 10 + 300, 1);
    for (const Vec3& world : {Vec3(0), Vec3(0.7f, 0.2f, 0.5f), Vec3(-0.6f, -0.4f, -0.3f)}) {
        const Vec2 expected = *camera.project(DVec3(world)) * (400.0f / 640.0f);
        EXPECT_NEAR(glm::distance(*eye.toScreen(world) - eye.corner, expected), 0, 0.01f);
    }
    EXPECT_FALSE(eye.toScreen({0, 0, 5}));
    Vec2 a, b;
    EXPECT_TRUE(eye.segmentToScreen({0, 0, 0}, {0, 0, 8}, a, b));
    EXPECT_FALSE(eye.segmentToScreen({0, 0, 5}, {0, 0, 8}, a, b));
}

TEST(SceneExtent, StrayPointsDoNotCountForTheFraming) {
    Mesh mesh;
    for (uint32_t i = 0; i < 999; ++i)
        mesh.positions.push_back({float(i % 10) / 9, float(i / 10 % 10) / 9, float(i / 100) / 9});
    mesh.positions.push_back({500, 500, 500});
    mesh.normals.assign(mesh.positions.size(), {0, 0, 1});
    for (uint32_t i = 0; i + 2 < mesh.positions.size(); ++i) mesh.triangles.push_back({i, i + 1, i + 2});
    const SceneExtent extent = extentOf(mesh);
    EXPECT_LT(extent.radius, 1);
    EXPECT_GT(extent.wholeRadius, 400);
    EXPECT_EQ(extent.ground, 0);
    EXPECT_FLOAT_EQ(roundStep(0.013f), 0.02f);
    EXPECT_FLOAT_EQ(roundStep(3), 5);
    EXPECT_FLOAT_EQ(roundStep(1), 1);
}

}  // namespace
}  // namespace relamp::ui
