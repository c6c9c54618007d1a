#include "viewport/gizmo.h"

#include <gtest/gtest.h>

namespace relamp::ui {
namespace {

/// Looks at the origin from a slanted place.
EyeView slanted(bool orthographic = false) {
    OrbitCamera camera;
    camera.azimuth = 0.7f, camera.elevation = 0.5f, camera.distance = 4, camera.orthographic = orthographic;
    return eyeOf(camera, Vec2(0), {800, 600}, Vec2(1), Vec3(0), 3);
}

GizmoDrag dragOf(const EyeView& eye, GizmoKind kind, GizmoHandle handle, const GizmoFrame& frame, const Vec3& from,
                 bool byKey = false) {
    return {kind, handle, frame, eye.rayAt(*eye.toScreen(from)), byKey};
}

TEST(Gizmo, KeepsItsSizeOnScreen) {
    const EyeView eye = slanted();
    for (const Vec3& origin : {Vec3(0), Vec3(1.2f, -0.8f, 0.3f), Vec3(-1.5f, 1, 0)}) {
        const GizmoFrame frame = gizmoFrameAt(origin, Mat3(1), eye, 80);
        EXPECT_NEAR(glm::distance(*eye.toScreen(origin), *eye.toScreen(origin + eye.up * frame.size)), 80, 0.1f);
    }
}

TEST(Gizmo, EveryVisibleHandleIsHitWhereItIsDrawn) {
    for (const bool orthographic : {false, true}) {
        const EyeView eye = slanted(orthographic);
        const GizmoFrame frame = gizmoFrameAt({0.1f, 0.2f, -0.1f}, Mat3(1), eye, 80);
        const auto hit = [&](GizmoKind kind, const Vec3& offset) {
            return hitTest(eye.rayAt(*eye.toScreen(frame.origin + offset * frame.size)), frame, eye, kind);
        };
        for (const GizmoKind kind : {GizmoKind::move, GizmoKind::scale}) {
            EXPECT_EQ(hit(kind, {0.7f, 0, 0}), GizmoHandle::x);
            EXPECT_EQ(hit(kind, {0, 0.7f, 0}), GizmoHandle::y);
            EXPECT_EQ(hit(kind, {0, 0, 0.7f}), GizmoHandle::z);
            EXPECT_EQ(hit(kind, {0.4f, 0.4f, 0}), GizmoHandle::xy);
            EXPECT_EQ(hit(kind, {0, 0.4f, 0.4f}), GizmoHandle::yz);
            EXPECT_EQ(hit(kind, {0.4f, 0, 0.4f}), GizmoHandle::zx);
            EXPECT_EQ(hit(kind, Vec3(0)), GizmoHandle::screen);
            EXPECT_EQ(hit(kind, {0, 0, -0.9f}), GizmoHandle::none);
        }
        EXPECT_EQ(hit(GizmoKind::rotate, ringRadius * glm::normalize(Vec3(1, 0.2f, 0))), GizmoHandle::z);
        EXPECT_EQ(hit(GizmoKind::rotate, screenRingRadius * eye.right), GizmoHandle::screen);
        EXPECT_EQ(hit(GizmoKind::rotate, Vec3(0)), GizmoHandle::none);
    }
}

TEST(Gizmo, HandlesHideWithinTenDegreesOfTheLineOfSight) {
    OrbitCamera camera;
    camera.azimuth = 0, camera.elevation = glm::radians(4.0f);
    const EyeView eye = eyeOf(camera, Vec2(0), {800, 600}, Vec2(1), Vec3(0), 3);
    const GizmoFrame frame = gizmoFrameAt(Vec3(0), Mat3(1), eye, 80);
    EXPECT_FALSE(handleVisible(GizmoKind::move, GizmoHandle::x, frame, eye));  // points at the eye
    EXPECT_TRUE(handleVisible(GizmoKind::move, GizmoHandle::y, frame, eye));
    EXPECT_FALSE(handleVisible(GizmoKind::move, GizmoHandle::xy, frame, eye));  // seen edge on
    EXPECT_TRUE(handleVisible(GizmoKind::move, GizmoHandle::yz, frame, eye));
    EXPECT_FALSE(handleVisible(GizmoKind::rotate, GizmoHandle::z, frame, eye));
    EXPECT_TRUE(handleVisible(GizmoKind::rotate, GizmoHandle::x, frame, eye));
}

TEST(Gizmo, MovesAlongAxisInPlaneAndOnScreen) {
    for (const bool orthographic : {false, true}) {
        const EyeView eye = slanted(orthographic);
        const Vec3 origin(0.1f, 0, 0.2f);
        const GizmoFrame frame = gizmoFrameAt(origin, Mat3(1), eye, 80);
        const auto moved = [&](GizmoHandle handle, const Vec3& by) {
            const GizmoMotion m = drag(dragOf(eye, GizmoKind::move, handle, frame, origin),
                                       eye.rayAt(*eye.toScreen(origin + by)), eye, {});
            return Vec3(m.change * Vec4(origin, 1)) - origin;
        };
        EXPECT_NEAR(glm::distance(moved(GizmoHandle::y, {0, 0.35f, 0}), Vec3(0, 0.35f, 0)), 0, 1e-3f);
        EXPECT_NEAR(glm::distance(moved(GizmoHandle::xy, {0.2f, -0.3f, 0}), Vec3(0.2f, -0.3f, 0)), 0, 1e-3f);
        const Vec3 onScreen = 0.3f * eye.right - 0.1f * eye.up;
        EXPECT_NEAR(glm::distance(moved(GizmoHandle::screen, onScreen), onScreen), 0, 1e-3f);
    }
}

TEST(Gizmo, StepsFallOnTheGridOfTheWorldCountedFromTheStart) {
    const EyeView eye = slanted();
    const Vec3 origin(0.13f, 0, 0);
    const GizmoFrame frame = gizmoFrameAt(origin, Mat3(1), eye, 80);
    GizmoSnap snap;
    snap.on = true;
    const auto ray = [&](float x) { return eye.rayAt(*eye.toScreen({x, 0, 0})); };
    const GizmoDrag d = dragOf(eye, GizmoKind::move, GizmoHandle::x, frame, origin);
    EXPECT_NEAR((drag(d, ray(0.33f), eye, snap).change * Vec4(origin, 1)).x, 0.3f, 1e-4f);
    EXPECT_NEAR((drag(d, ray(0.36f), eye, snap).change * Vec4(origin, 1)).x, 0.4f, 1e-4f);
    EXPECT_EQ((drag(d, ray(0.36f), eye, snap).change * Vec4(origin, 1)).y, 0);
}

TEST(Gizmo, TurnsTheWayTheMouseGoesAboutThePivot) {
    const EyeView eye = slanted();
    const Vec3 origin(0.2f, -0.1f, 0.1f);
    const GizmoFrame frame = gizmoFrameAt(origin, Mat3(1), eye, 80);
    const auto onRing = [&](float degrees) {
        return origin + frame.size * Vec3(std::cos(glm::radians(degrees)), std::sin(glm::radians(degrees)), 0);
    };
    const GizmoDrag d = dragOf(eye, GizmoKind::rotate, GizmoHandle::z, frame, onRing(20));
    const GizmoMotion m = drag(d, eye.rayAt(*eye.toScreen(onRing(57))), eye, {});
    EXPECT_NEAR(m.degrees, 37, 0.05f);
    EXPECT_NEAR(glm::distance(Vec3(m.change * Vec4(origin, 1)), origin), 0, 1e-5f);  // the pivot stays
    GizmoSnap snap;
    snap.on = true;
    EXPECT_NEAR(drag(d, eye.rayAt(*eye.toScreen(onRing(57))), eye, snap).degrees, 30, 1e-3f);
    EXPECT_NEAR(drag(d, eye.rayAt(*eye.toScreen(onRing(57))), eye, {}, 90.0f).degrees, 90, 1e-4f);
}

TEST(Gizmo, ScalesOneAxisOrAllAndNeverToNothing) {
    const EyeView eye = slanted();
    const GizmoFrame frame = gizmoFrameAt(Vec3(0), Mat3(1), eye, 80);
    const auto at = [&](const Vec3& p) { return eye.rayAt(*eye.toScreen(p * frame.size)); };
    const GizmoDrag alongX{GizmoKind::scale, GizmoHandle::x, frame, at({0.8f, 0, 0}), false};
    EXPECT_NEAR(drag(alongX, at({1.6f, 0, 0}), eye, {}).factor.x, 2, 0.01f);
    EXPECT_EQ(drag(alongX, at({1.6f, 0, 0}), eye, {}).factor.y, 1);
    const GizmoDrag even{GizmoKind::scale, GizmoHandle::screen, frame, at(eye.right), true};
    EXPECT_NEAR(drag(even, at(0.5f * eye.right), eye, {}).factor.z, 0.5f, 0.01f);
    EXPECT_NE(drag(even, at(eye.right), eye, {}, 0.0f).factor.x, 0);
}

TEST(Gizmo, LocalAxesAreTheFramesOwn) {
    const EyeView eye = slanted();
    const GizmoFrame frame = gizmoFrameAt(Vec3(0), frameAround(glm::normalize(Vec3(1, 1, 1))), eye, 80);
    const GizmoMotion m = drag({GizmoKind::move, GizmoHandle::z, frame, eye.rayAt(*eye.toScreen(Vec3(0))), true},
                               eye.rayAt({0, 0}), eye, {}, 0.5f);
    EXPECT_NEAR(glm::distance(Vec3(m.change[3]), 0.5f * glm::normalize(Vec3(1, 1, 1))), 0, 1e-5f);
    EXPECT_EQ(m.readout, "Move Z 0.500 m");
}

TEST(Gizmo, ARayBesideTheAxisGivesNoJump) {
    const EyeView eye = slanted();
    const GizmoFrame frame = gizmoFrameAt(Vec3(0), Mat3(1), eye, 80);
    const GizmoDrag d = dragOf(eye, GizmoKind::move, GizmoHandle::x, frame, Vec3(0));
    Ray along = d.start;
    along.direction = {1, 0, 0};  // runs with the axis: nothing sensible can be said
    EXPECT_EQ(drag(d, along, eye, {}).change, Mat4(1));
}

}  // namespace
}  // namespace relamp::ui
