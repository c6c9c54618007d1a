#include "capture/registration_fix.h"

#include <gtest/gtest.h>

#include "capture/capture.h"
#include "support/estimates.h"

namespace relamp {
namespace {

Capture sheetCapture() {
    Capture capture;
    capture.mesh = test::sceneOf(test::sheet({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, 4, 4)).mesh;
    View view;
    view.name = "a.exr";
    view.camera = test::cameraAt({0, -2, 1}, {0, 0, 0}, 64, 48, 64);
    capture.views.push_back(view);
    return capture;
}

TEST(RegistrationFix, ShiftsAndTurnsACameraAlongItsOwnAxes) {
    const Camera camera = test::cameraAt({0, -2, 1}, {0, 0, 0}, 64, 48, 64);
    const Camera shifted = corrected(camera, {"", DVec3(0), DVec3(0.1, 0, 0)});
    EXPECT_NEAR(glm::length(shifted.position() - (camera.position() + 0.1 * DVec3(camera.worldFromCamera[0]))), 0,
                1e-12);
    // A turn to the left about the camera's own up moves what it sees to the right by tan(angle) x focal length.
    const Camera turned = corrected(camera, {"", DVec3(0, 0.01, 0), DVec3(0)});
    const Vec2 before = *camera.project(DVec3(0)), after = *turned.project(DVec3(0));
    EXPECT_NEAR(after.x - before.x, 64 * std::tan(0.01), 1e-3);
    EXPECT_NEAR(after.y, before.y, 1e-3);
}

TEST(RegistrationFix, TwoCorrectionsOfOneCameraAreOne) {
    const Camera camera = test::cameraAt({1, 2, 3}, {0, 0, 0}, 64, 48, 60);
    const PoseFix first{"a", {0.1, -0.2, 0.05}, {0.3, 0, -0.1}}, second{"a", {-0.02, 0.4, 0.1}, {0, 0.2, 0.5}};
    const Camera twice = corrected(corrected(camera, first), second), once = corrected(camera, composed(first, second));
    for (int c = 0; c < 4; ++c)
        for (int r = 0; r < 4; ++r) EXPECT_NEAR(once.worldFromCamera[c][r], twice.worldFromCamera[c][r], 1e-12);
    EXPECT_EQ(composed({"a"}, {"a"}).turn, DVec3(0));
    EXPECT_EQ(composed(first, second).view, "a");
}

TEST(RegistrationFix, MovesVerticesAndTurnsTheirNormals) {
    Capture capture = sheetCapture();
    RegistrationFix fix;
    fix.step = 0.01f;
    // A slope of 0.1 along x.
    for (const Vec3& p : capture.mesh.positions) fix.steps.push_back(int(std::lround(10 * p.x)));
    applyRegistration(fix, capture);
    for (size_t v = 0; v < capture.mesh.vertexCount(); ++v) {
        EXPECT_NEAR(capture.mesh.positions[v].z, 0.1f * capture.mesh.positions[v].x, 1e-6f);
        EXPECT_NEAR(capture.mesh.normals[v].x, -0.0995f, 1e-3f);
        EXPECT_NEAR(glm::length(capture.mesh.normals[v]), 1, 1e-5f);
    }
}

TEST(RegistrationFix, KeepsNormalsWhereOutlinesMove) {
    Capture capture = sheetCapture();
    RegistrationFix fix;
    fix.outlineStep = 0.01f;
    for (const Vec3& p : capture.mesh.positions) fix.outlineSteps.push_back(int(std::lround(10 * p.x)));
    const std::vector<Vec3> normals = capture.mesh.normals;
    applyRegistration(fix, capture);
    for (size_t v = 0; v < capture.mesh.vertexCount(); ++v)
        EXPECT_NEAR(capture.mesh.positions[v].z, 0.1f * capture.mesh.positions[v].x, 1e-6f);
    EXPECT_EQ(capture.mesh.normals, normals);
    fix.outlineSteps.resize(capture.mesh.vertexCount() + 1);
    EXPECT_THROW(applyRegistration(fix, capture), Error);
}

TEST(RegistrationFix, FlattensAfterAllElse) {
    Capture capture = sheetCapture();
    RegistrationFix fix;
    fix.step = fix.flatStep = 0.01f;
    // A slope, and back again along its own normals.
    for (const Vec3& p : capture.mesh.positions) fix.steps.push_back(int(std::lround(10 * p.x)));
    for (const int s : fix.steps) fix.flatSteps.push_back(-s);
    EXPECT_FALSE(RegistrationFix({{}, 0, {}, 0, {}, 0.01f, {1}}).empty());
    applyRegistration(fix, capture);
    for (size_t v = 0; v < capture.mesh.vertexCount(); ++v) {
        EXPECT_NEAR(capture.mesh.positions[v].z, 0, 2e-3f);
        EXPECT_GT(capture.mesh.normals[v].z, 0.999f);
    }
    fix.flatSteps.resize(capture.mesh.vertexCount() + 1);
    EXPECT_THROW(applyRegistration(fix, capture), Error);
}

TEST(RegistrationFix, MovesEachOfTwoViewsOfOneName) {
    Capture capture = sheetCapture();
    capture.views.push_back(capture.views[0]);
    const Camera given = capture.views[0].camera;
    const PoseFix first{"a.exr", DVec3(0), DVec3(0.1, 0, 0)}, second{"a.exr", DVec3(0), DVec3(0, 0.2, 0)};
    applyRegistration({{first, second}, 0, {}}, capture);
    EXPECT_EQ(capture.views[0].camera.worldFromCamera, corrected(given, first).worldFromCamera);
    EXPECT_EQ(capture.views[1].camera.worldFromCamera, corrected(given, second).worldFromCamera);
}

TEST(RegistrationFix, RefusesWhatTheCaptureDoesNotHave) {
    Capture capture = sheetCapture();
    EXPECT_THROW(applyRegistration({{{"b.exr", DVec3(0), DVec3(0)}}, 0, {}}, capture), Error);
    EXPECT_THROW(applyRegistration({{{"a.exr", DVec3(2, 0, 0), DVec3(0)}}, 0, {}}, capture), Error);
    EXPECT_THROW(applyRegistration({{{"a.exr", DVec3(0), DVec3(NAN)}}, 0, {}}, capture), Error);
    EXPECT_THROW(applyRegistration({{}, 0.1f, std::vector<int>(26, 1)}, capture), Error);
    EXPECT_THROW(applyRegistration({{}, INFINITY, {1}}, capture), Error);
    capture = sheetCapture();
    EXPECT_NO_THROW(applyRegistration({{}, 0.1f, {1, 2}}, capture));
}

}  // namespace
}  // namespace relamp
