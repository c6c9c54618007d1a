// A sun among the added lights.
#include <gtest/gtest.h>

#include "relight/frame.h"
#include "relight/live/live_scene.h"
#include "support/estimates.h"

namespace relamp {
namespace {

/// A plane and a small square 0.5 m above its middle.
struct Yard {
    std::shared_ptr<const Scene> scene;
    std::shared_ptr<const Estimate> estimate;
    Yard() {
        Mesh mesh = test::sheet({-2, -2, 0}, {4, 0, 0}, {0, 4, 0}, 80, 80);
        test::append(mesh, test::squareAbove(0.6f, 0, 0, 0.5f, 2));
        scene = std::make_shared<const Scene>(test::sceneOf(mesh));
        estimate = std::make_shared<const Estimate>(test::matteEstimate(*scene, Rgb(0.5f), Rgb(0)));
    }
    /// Tilted by `degrees` from straight above towards +X.
    Look under(float degrees, float angle, const Vec3& place = Vec3(0)) const {
        const float a = degrees * pi / 180;
        Look look;
        AddedEmitter sun;
        sun.shape = EmitterShape::sun;
        sun.id = "sun-1";
        sun.matrix = Mat4(frameAround({std::sin(a), 0, std::cos(a)}));
        sun.matrix[3] = Vec4(place, 1);
        sun.size = Vec2(angle);
        sun.radiance = Rgb(2, 1, 0.5f);
        look.added.push_back(sun);
        return look;
    }
    Frame frameOf(const Look& look) const {
        const RelitScene relit = test::relitOf(*scene, *estimate, look);
        FrameOptions options;
        Progress progress;
        return renderFrame(relit, test::cameraAt({0, 0, 6}, {0, 0, 0}, 48, 48, 72, {0, 1, 0}), options, progress);
    }
};

TEST(Sun, LightsAPlaneByItsCosineWhereverItIsDrawn) {
    const Yard yard;
    for (const Vec3& place : {Vec3(0), Vec3(50, -3, 2)}) {
        const Frame frame = yard.frameOf(yard.under(30, 0.53f, place));
        for (size_t p = 0; p < frame.beauty.size(); ++p) {
            const Vec3 at = frame.position[p];
            // Out of the square and its shadow, which lies 0.29 m towards -X.
            if (at.z > 0.1f || (std::abs(at.y) < 0.5f && at.x > -0.8f && at.x < 0.6f)) continue;
            EXPECT_NEAR(frame.beauty[p].x, 0.5 * 2 * std::cos(pi / 6), 0.01) << at.x << " " << at.y;
            EXPECT_NEAR(frame.beauty[p].z, 0.5 * 0.5 * std::cos(pi / 6), 0.0025);
            EXPECT_NEAR(frame.byEmitter[0][p].y, frame.beauty[p].y, 1e-6);
        }
    }
}

TEST(Sun, CastsAShadowAsSharpAsItsAngle) {
    const Yard yard;
    for (const float angle : {0.53f, 20.0f}) {
        const Frame frame = yard.frameOf(yard.under(0, angle));
        // The penumbra at half a metre is as wide as the angle: 5 mm or 18 cm.
        const float wide = 0.5f * std::tan(angle * pi / 360) + 0.06f;
        int partly = 0;
        for (size_t p = 0; p < frame.beauty.size(); ++p) {
            const Vec3 at = frame.position[p];
            if (at.z > 0.1f) continue;
            const float beyond = std::max(std::abs(at.x), std::abs(at.y)) - 0.3f;
            const float light = frame.beauty[p].y;
            if (beyond > wide) {
                EXPECT_GT(light, 0.49f);
            } else if (light > 0.02f && light < 0.48f) {
                ++partly;
            }
        }
        EXPECT_EQ(partly > 20, angle > 1) << partly;
    }
}

TEST(Sun, ShowsTheSameInTheViewportAndFollowsItsRotation) {
    const Yard yard;
    Progress progress;
    LiveScene live(yard.scene, yard.estimate, {}, progress);
    for (const float degrees : {0.0f, 40.0f}) {
        live.setLook(yard.under(degrees, 0.53f));
        while (!live.refine(0.5, progress)) {}
        const auto frame = live.frame();
        const float expected = 0.5f * std::cos(degrees * pi / 180), shift = -0.5f * std::tan(degrees * pi / 180);
        for (size_t v = 0; v < 81 * 81; ++v) {
            const Vec3 p = yard.scene->mesh.positions[v];
            const float beside = std::max(std::abs(p.x - shift), std::abs(p.y)) - 0.3f;
            if (std::abs(beside) < 0.06f) continue;
            const float wanted = beside > 0 ? expected : 0.0f;
            EXPECT_NEAR(frame->radiance[v].y, wanted, 0.005f * expected) << p.x << " " << p.y;
        }
    }
}

}  // namespace
}  // namespace relamp
