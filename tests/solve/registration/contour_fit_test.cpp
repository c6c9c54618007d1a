// A ball that the mesh has too small grows to the outlines in its photographs; one that fits stays.
#include "solve/registration/contour_fit.h"

#include <gtest/gtest.h>

#include "base/parallel.h"
#include "base/statistics.h"
#include "support/estimates.h"
#include "support/stopping.h"

namespace relamp {
namespace {

/// A matte ball of a metre before a grey background, from near one side, and a mesh of any radius.
struct PhotographedBall {
    static constexpr int side = 180, views = 8;
    static constexpr double focal = 300, distance = 4;
    Capture capture;
    Scene scene;

    explicit PhotographedBall(float radius) {
        static const std::vector<View> taken = photographs();
        capture.mesh = test::ball({0, 0, 0}, radius, 80, 160);
        capture.views = taken;
        scene = test::sceneOf(capture.mesh);
    }
    static std::vector<View> photographs() {
        std::vector<View> all;
        for (int i = 0; i < views; ++i) {
            const double turn = 0.03 * (i - views / 2);
            View view;
            view.name = std::to_string(i);
            view.camera = test::cameraAt({distance * std::cos(turn), distance * std::sin(turn), 0.1 * (i % 3) - 0.1},
                                         {0, 0, 0}, side, side, focal);
            view.image = Image(side, side);
            for (int y = 0; y < side; ++y)
                for (int x = 0; x < side; ++x) view.image.at(x, y) = pixel(view.camera, x, y);
            all.push_back(std::move(view));
        }
        return all;
    }
    /// Mean over 8 x 8 rays.
    static Rgb pixel(const Camera& camera, int x, int y) {
        Rgb sum(0);
        for (int k = 0; k < 64; ++k) {
            const DVec3 d(
                camera.rayDirection(Vec2(float(x) + (float(k % 8) + 0.5f) / 8, float(y) + (float(k / 8) + 0.5f) / 8)));
            const DVec3 eye = camera.position();
            const double b = glm::dot(eye, d), c = glm::dot(eye, eye) - 1, inside = b * b - c;
            const DVec3 normal = eye + d * (-b - std::sqrt(std::max(0.0, inside)));
            sum += inside > 0 ? Rgb(float(0.7 + 0.2 * normal.z)) : Rgb(0.2f, 0.22f, 0.25f);
        }
        return sum / 64.0f;
    }
    std::vector<ContourPoint> contours() const {
        std::vector<Camera> cameras;
        for (const View& view : capture.views) cameras.push_back(view.camera);
        return findContours(capture.views, cameras, scene.mesh, *scene.cameraTracer, 1e-3f, Progress());
    }
    ContourEstimate aligned(int threads = 0) const {
        const ThreadLimit limit(threads);
        Progress progress;
        return alignContours(capture, scene, {}, scene.mesh.vertexCount(), {}, 1e-3f, progress);
    }
};

float medianOffset(const std::vector<ContourPoint>& points) {
    std::vector<float> offsets;
    for (const ContourPoint& p : points) offsets.push_back(p.offset);
    return medianOf(std::move(offsets));
}

TEST(Contours, LieWhereAnExactMeshHasThem) {
    const PhotographedBall ball(1);
    const std::vector<ContourPoint> points = ball.contours();
    EXPECT_GT(points.size(), 800u);
    EXPECT_NEAR(medianOffset(points), 0, 0.1f);
    EXPECT_FALSE(ball.aligned().needed());
    EXPECT_TRUE(ball.aligned().fix.empty());
}

TEST(Contours, TellByHowManyPixelsTheMeshIsTooSmall) {
    const PhotographedBall ball(0.99f);
    // A ball of radius r at distance D is seen under the angle asin(r / D).
    const double D = std::sqrt(16 + 0.01 * 2 / 3), truth = std::tan(std::asin(1 / D)),
                 mesh = std::tan(std::asin(0.99 / D));
    EXPECT_NEAR(medianOffset(ball.contours()), PhotographedBall::focal * (truth - mesh), 0.15);
}

TEST(Contours, ArePointedAwayFromTheSurface) {
    const PhotographedBall ball(1);
    for (const ContourPoint& p : ball.contours()) {
        const Vec3 middle = 0.5f * (ball.scene.mesh.positions[p.vertex[0]] + ball.scene.mesh.positions[p.vertex[1]]);
        const std::optional<Vec2> at = ball.capture.views[p.view].camera.project(DVec3(middle));
        const Vec2 fromCentre = *at - Vec2(PhotographedBall::side / 2.0f);
        EXPECT_GT(glm::dot(p.outward, glm::normalize(fromCentre)), 0.95f);
    }
}

TEST(Contours, BringTheSurfaceToThePhotographs) {
    PhotographedBall ball(0.99f);
    const ContourEstimate found = ball.aligned();
    ASSERT_TRUE(found.needed()) << toText(found);
    EXPECT_LT(found.after, 0.5 * found.before);
    applyRegistration(found.fix, ball.capture);
    // Around the ring that outlines lie on.
    std::vector<float> radii;
    for (const Vec3& p : ball.capture.mesh.positions)
        if (std::abs(p.x - 0.25f) < 0.05f) radii.push_back(glm::length(p));
    EXPECT_NEAR(medianOf(radii), 1, 0.003f);
    ball.scene = test::sceneOf(ball.capture.mesh);
    EXPECT_FALSE(ball.aligned().needed());
}

TEST(Contours, KeepWhatTheyStartFrom) {
    const PhotographedBall ball(0.99f);
    RegistrationFix start;
    for (const View& view : ball.capture.views) start.poses.push_back({view.name, DVec3(0.001, 0, 0), DVec3(0)});
    Progress progress;
    const ContourEstimate found =
        alignContours(ball.capture, ball.scene, start, ball.scene.mesh.vertexCount(), {}, 1e-3f, progress);
    ASSERT_TRUE(found.needed());
    EXPECT_TRUE(found.fix.poses == start.poses);
}

TEST(Contours, AreOutOfPlaceUnderCamerasThatAreFarOff) {
    const PhotographedBall ball(1);
    RegistrationFix off;
    for (const View& view : ball.capture.views) off.poses.push_back({view.name, DVec3(0, 0.012, 0), DVec3(0)});
    Progress progress;
    const size_t there = outlinesInPlace(ball.capture, ball.scene, {}, 1e-3f, progress);
    EXPECT_GT(there, 800u);
    // By 3.6 pixels sideways: only what lies above and below stays, near the poles with most edges.
    const size_t left = outlinesInPlace(ball.capture, ball.scene, off, 1e-3f, progress);
    EXPECT_LT(left, there / 2);
    EXPECT_GT(left, there / 12);
}

TEST(Contours, ThatHaveToTellAloneHaveToTellMore) {
    const PhotographedBall ball(0.99f);
    const ContourEstimate besides = ball.aligned();
    ASSERT_TRUE(besides.needed());
    Progress progress;
    const ContourEstimate alone = alignContours(ball.capture, ball.scene, {}, ball.scene.mesh.vertexCount(), {}, 1e-3f,
                                                progress, 0.9 * besides.after / besides.before);
    EXPECT_FALSE(alone.needed()) << toText(alone);
    EXPECT_TRUE(alone.fix.empty());
}

TEST(Contours, LeaveEmittersAlone) {
    const PhotographedBall ball(0.99f);
    Progress progress;
    const std::vector<uint8_t> all(ball.scene.mesh.vertexCount(), 1);
    const ContourEstimate found = alignContours(ball.capture, ball.scene, {}, all.size(), all, 1e-3f, progress);
    EXPECT_EQ(found.points, 0u);
    EXPECT_FALSE(found.needed());
}

TEST(Contours, ClippedAndMaskedPixelsTellNone) {
    PhotographedBall ball(0.99f);
    for (View& view : ball.capture.views) view.saturation = 0.1f;
    EXPECT_TRUE(ball.contours().empty());
    for (View& view : ball.capture.views) {
        view.saturation = 0;
        view.image.usable.assign(view.image.pixels.size(), 0);
    }
    EXPECT_TRUE(ball.contours().empty());
    EXPECT_FALSE(ball.aligned().needed());
}

TEST(Contours, StopHalfWay) {
    const PhotographedBall ball(0.99f);
    test::expectStopsHalfWay([&](Progress& progress) {
        for (int k = 0; k < 20; ++k)
            alignContours(ball.capture, ball.scene, {}, ball.scene.mesh.vertexCount(), {}, 1e-3f, progress);
    });
}

TEST(Contours, HaveTheSameBitsOnOneAndManyThreads) {
    const PhotographedBall ball(0.99f);
    EXPECT_TRUE(ball.aligned(1).fix == ball.aligned().fix);
}

}  // namespace
}  // namespace relamp
