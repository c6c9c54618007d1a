#include "relight/bounced_light.h"

#include <gtest/gtest.h>

#include "base/parallel.h"
#include "relight/frame.h"
#include "relight/live/live_scene.h"
#include "support/estimates.h"

namespace relamp {
namespace {

/// The inside of a ball whose skin reflects half of a green and a quarter of a red emitter's light, with a small ball
/// emitter in the middle.
struct EmitterInABall {
    Scene scene;
    Estimate estimate;
    explicit EmitterInABall(float emitterRadius = 0.2f) {
        Mesh mesh = test::ball({0, 0, 0}, 1, 24, 36);
        for (Vec3& n : mesh.normals) n = -n;
        for (Triangle& t : mesh.triangles) std::swap(t[1], t[2]);
        const auto emitter = test::append(mesh, test::ball({0, 0, 0}, emitterRadius, 16, 24));
        scene = test::sceneOf(mesh);
        estimate =
            test::matteEstimate(scene, {0.25f, 0.5f, 0.5f}, Rgb(0), test::emittersOf(scene, {emitter}, {Rgb(10)}));
        estimate.interreflection = true;
    }
};

Frame frameOf(const RelitScene& relit) {
    FrameOptions options;
    Progress progress;
    return renderFrame(relit, test::cameraAt({0.5, 0, 0}, {0.9, 0.1, 0.1}, 24, 24, 40), options, progress);
}

TEST(BouncedLight, AnEmitterInABallIsBrighterByTheGeometricSeries) {
    const EmitterInABall world;
    Progress progress;
    const RelitScene relit = applyLook(world.scene, world.estimate, {}, progress);
    ASSERT_FALSE(relit.bounced.empty());
    // Direct: form factor r^2 of the emitter seen from the skin, and the emitter hides r^2 of what the skin would see
    // of itself.
    const double formFactor = 0.2 * 0.2, hidden = 1 - formFactor;
    const Frame frame = frameOf(relit);
    Rgb mean(0);
    for (const Rgb& c : frame.beauty) mean += c / float(frame.beauty.size());
    for (int c = 0; c < 3; ++c) {
        const double albedo = c == 0 ? 0.25 : 0.5, expected = albedo * 10 * formFactor / (1 - albedo * hidden);
        EXPECT_NEAR(mean[c], expected, 0.03 * expected) << c;
    }
}

TEST(BouncedLight, ACoatingPassesOnWhatItReflects) {
    // A coating of index 1.5 reflects 7 to 9 % of even light, a bare lobe nearly all.
    BrdfBasis basis{{Lobe{}, Lobe{Lobe::Kind::ggxDielectric, 0.05f, "coating"}, Lobe{Lobe::Kind::ggx, 0.01f, "bare"}}};
    const std::vector<std::vector<Rgb>> weight{{Rgb(0.5f), Rgb(0.5f), Rgb(0), Rgb(0.5f)},
                                               {Rgb(0), Rgb(1), Rgb(0), Rgb(1)},
                                               {Rgb(0), Rgb(0), Rgb(0.8f), Rgb(0)}};
    const std::vector<Rgb> passed = bouncingAlbedo(basis, weight, {0, 0, 0, 1});
    EXPECT_EQ(passed[0], Rgb(0.5f));
    EXPECT_NEAR(passed[1].y, 0.58f, 0.012f);
    EXPECT_NEAR(passed[2].y, 0.8f, 0.03f);
    EXPECT_EQ(passed[3], Rgb(0));
}

TEST(BouncedLight, IsLeftOutWhereTheEstimateHasNone) {
    EmitterInABall world;
    world.estimate.interreflection = false;
    Progress progress;
    const RelitScene relit = applyLook(world.scene, world.estimate, {}, progress);
    EXPECT_TRUE(relit.bounced.empty());
    Rgb mean(0);
    const Frame frame = frameOf(relit);
    for (const Rgb& c : frame.beauty) mean += c / float(frame.beauty.size());
    EXPECT_NEAR(mean.y, 0.5 * 10 * 0.04, 0.03 * 0.2);
}

TEST(BouncedLight, TheLiveViewHasItToo) {
    const EmitterInABall world;
    Progress progress;
    LiveScene live(std::make_shared<Scene>(world.scene), std::make_shared<Estimate>(world.estimate), {}, progress);
    Look look;
    for (const float power : {1.0f, 0.5f, 3.0f}) {
        look.emitters = {{"", true, Mat4(1), Rgb(power)}};
        look.emitters[0].id = world.estimate.emitters.emitters[0].id;
        live.setLook(look);
        while (!live.refine(1, progress)) {}
        const auto frame = live.frame();
        double mean = 0;
        const size_t n = world.scene.mesh.vertexCount() - world.estimate.emitters.emitters[0].vertices.size();
        for (size_t v = 0; v < n; ++v) mean += frame->radiance[v].y / double(n);
        const double expected = power * 0.5 * 10 * 0.04 / (1 - 0.5 * 0.96);
        EXPECT_NEAR(mean, expected, 0.04 * expected) << power;
    }
}

TEST(BouncedLight, BelongsToTheEmitterItCameFrom) {
    const EmitterInABall world;
    Progress progress;
    const Frame frame = frameOf(applyLook(world.scene, world.estimate, {}, progress));
    for (size_t p = 0; p < frame.beauty.size(); ++p) {
        EXPECT_EQ(frame.world[p], Rgb(0));
        EXPECT_EQ(frame.byEmitter[0][p], frame.beauty[p]);
    }
}

TEST(BouncedLight, AMetalShowsWhatSurfacesSend) {
    EmitterInABall world;
    // A metal strip: no matte part, a lobe of weight 1.
    world.estimate.reflectance.basis.lobes.push_back({Lobe::Kind::ggx, 0.1f, "ggx"});
    world.estimate.reflectance.weight.push_back(std::vector<Rgb>(world.scene.mesh.vertexCount(), Rgb(0)));
    for (size_t v = 0; v < world.scene.mesh.vertexCount(); ++v)
        if (world.scene.mesh.positions[v].x > 0.6f) {
            world.estimate.reflectance.weight[0][v] = Rgb(0);
            world.estimate.reflectance.weight[1][v] = Rgb(1);
        }
    Progress progress;
    const Frame with = frameOf(applyLook(world.scene, world.estimate, {}, progress));
    world.estimate.interreflection = false;
    const Frame without = frameOf(applyLook(world.scene, world.estimate, {}, progress));
    double lit = 0, dark = 0;
    for (size_t p = 0; p < with.beauty.size(); ++p) {
        lit += with.beauty[p].y;
        dark += without.beauty[p].y;
    }
    EXPECT_GT(lit, dark + 0.05 * double(with.beauty.size()));
}

TEST(BouncedLight, HasTheSameBitsOnAnyNumberOfThreads) {
    const EmitterInABall world;
    const auto run = [&](int threads) {
        const ThreadLimit limit(threads);
        Progress progress;
        return applyLook(world.scene, world.estimate, {}, progress).bounced.byEmitter[0];
    };
    EXPECT_EQ(run(1), run(0));
}

}  // namespace
}  // namespace relamp
