#include "relight/frame.h"

#include <gtest/gtest.h>

#include "base/parallel.h"
#include "support/estimates.h"
#include "support/stopping.h"

namespace relamp {
namespace {

using test::append;

Frame render(const RelitScene& relit, const Camera& camera, int samples = 8) {
    FrameOptions options;
    options.samplesPerPixel = samples;
    Progress progress;
    return renderFrame(relit, camera, options, progress);
}

/// Straight down on the plane z = 0 from 3 m.
Camera fromAbove(int side = 24, double focal = 30) {
    return test::cameraAt({0, 0, 3}, {0, 0, 0}, side, side, focal, {0, 1, 0});
}

/// Mean over the image of value / expected(position), for pixels on the plane z = 0.
template <class Expected>
double meanRatio(const Frame& frame, const std::vector<Rgb>& values, Expected&& expected) {
    double sum = 0, n = 0;
    for (size_t p = 0; p < values.size(); ++p) {
        sum += values[p].y / expected(frame.position[p]);
        ++n;
    }
    return sum / n;
}

Look onlyAdded(const AddedEmitter& emitter) {
    Look look;
    look.added.push_back(emitter);
    return look;
}

TEST(Frame, OfAPlaneUnderAConstantEnvironmentIsItsAlbedo) {
    const Scene scene = test::sceneOf(test::sheet({-4, -4, 0}, {8, 0, 0}, {0, 8, 0}, 2, 2));
    const RelitScene relit = test::relitOf(scene, test::matteEstimate(scene, Rgb(0.8f, 0.5f, 0.1f), Rgb(1, 2, 3)));
    const Frame frame = render(relit, fromAbove());
    for (size_t p = 0; p < frame.beauty.size(); ++p) {
        // One pixel is noisy, their mean below is not.
        EXPECT_NEAR(frame.beauty[p].x, 0.8, 0.8 * 0.09);
        EXPECT_NEAR(frame.beauty[p].y, 1.0, 0.09);
        EXPECT_NEAR(frame.beauty[p].z, 0.3, 0.3 * 0.09);
        EXPECT_NEAR(frame.alpha[p], 1, 1e-5);
        EXPECT_NEAR(frame.depth[p], 3, 1e-4);
        EXPECT_LT(glm::length(frame.normal[p] - Vec3(0, 0, 1)), 1e-5f);
        EXPECT_LT(glm::length(frame.albedo[p] - Rgb(0.8f, 0.5f, 0.1f)), 1e-5f);
    }
    EXPECT_NEAR(meanRatio(frame, frame.beauty, [](const Vec3&) { return 1.0; }), 1, 0.003);
}

TEST(Frame, OfAPlaneUnderASquareEmitterIsAlbedoTimesRadianceTimesFormFactor) {
    const Scene scene = test::sceneOf(test::sheet({-4, -4, 0}, {8, 0, 0}, {0, 8, 0}, 2, 2));
    const RelitScene relit = test::relitOf(
        scene, test::matteEstimate(scene, Rgb(0.5f), Rgb(0)),
        onlyAdded({EmitterShape::rectangle, "lamp", test::translation({0.5f, 0, 3.5f}), Vec2(0.5f), Rgb(100)}));
    const Frame frame = render(relit, fromAbove(), 16);
    const auto expected = [](const Vec3& p) {
        return 50 * test::rectangleFormFactor(0.25 - p.x, 0.75 - p.x, -0.25 - p.y, 0.25 - p.y, 3.5);
    };
    EXPECT_NEAR(meanRatio(frame, frame.beauty, expected), 1, 0.003);
    for (size_t p = 0; p < frame.beauty.size(); ++p)
        EXPECT_NEAR(frame.beauty[p].y / expected(frame.position[p]), 1, 0.04);
}

TEST(Frame, OfAPlaneUnderALargeNearEmitterIsRightTooAndShadowsAreBlack) {
    Mesh mesh = test::sheet({-4, -4, 0}, {8, 0, 0}, {0, 8, 0}, 2, 2);
    append(mesh, test::sheet({-4, -4, 0.2f}, {3.5f, 0, 0}, {0, 8, 0}));  // a shelf over x < -0.5, its top dark
    const Scene scene = test::sceneOf(mesh);
    Look look;
    look.added.push_back({EmitterShape::rectangle, "lamp", test::translation({1.5f, 0, 1}), Vec2(2), Rgb(4)});
    const RelitScene relit = test::relitOf(scene, test::matteEstimate(scene, Rgb(1), Rgb(0)), look);
    // From below the emitter, at a slant.
    const Frame frame = render(relit, test::cameraAt({0.6, -2.5, 0.6}, {0.6, 0, 0}, 32, 24, 40), 16);
    size_t lit = 0;
    double sum = 0;
    for (size_t p = 0; p < frame.beauty.size(); ++p) {
        const Vec3 x = frame.position[p];
        if (frame.depth[p] > 1e3f || std::abs(x.z) > 1e-3f || x.x < 0) continue;  // penumbra of the shelf on the left
        const double expected = 4 * test::rectangleFormFactor(0.5 - x.x, 2.5 - x.x, -1 - x.y, 1 - x.y, 1);
        EXPECT_NEAR(frame.beauty[p].y, expected, 0.4 * expected);
        sum += frame.beauty[p].y / expected;
        ++lit;
    }
    ASSERT_GT(lit, 100u);
    EXPECT_NEAR(sum / double(lit), 1, 0.005);
}

TEST(Frame, OfAPlaneUnderASphereIsTheSquareOfTheSineOfItsHalfAngle) {
    const Scene scene = test::sceneOf(test::sheet({-4, -4, 0}, {8, 0, 0}, {0, 8, 0}, 2, 2));
    const RelitScene relit =
        test::relitOf(scene, test::matteEstimate(scene, Rgb(1), Rgb(0)),
                      onlyAdded({EmitterShape::sphere, "bulb", test::translation({0, 0, 4}), Vec2(0.6f), Rgb(30)}));
    const Frame frame = render(relit, fromAbove(), 16);
    // Form factor of a sphere wholly above the horizon: (r / d)^2 cos.
    const auto expected = [](const Vec3& p) {
        const double d2 = p.x * p.x + p.y * p.y + 16.0;
        return 30 * 0.09 / d2 * (4 / std::sqrt(d2));
    };
    EXPECT_NEAR(meanRatio(frame, frame.beauty, expected), 1, 0.005);
}

TEST(Frame, ShowsEmittersTheirFrontOnlyAndTheEnvironmentBehind) {
    const Scene scene = test::sceneOf(test::sheet({-0.2f, -0.2f, -9}, {0.4f, 0, 0}, {0, 0.4f, 0}));
    const RelitScene relit =
        test::relitOf(scene, test::matteEstimate(scene, Rgb(0), Rgb(0.25f, 0.5f, 1)),
                      onlyAdded({EmitterShape::rectangle, "lamp", test::translation({0, 0, 0}), Vec2(1), Rgb(7)}));
    const Frame below = render(relit, test::cameraAt({0, 0, -3}, {0, 0, 0}, 24, 24, 30, {0, 1, 0}), 2),
                above = render(relit, fromAbove(), 2);
    const size_t middle = 12 * 24 + 12, corner = 0;
    EXPECT_EQ(below.beauty[middle], Rgb(7));
    EXPECT_EQ(below.byEmitter[0][middle], Rgb(7));
    EXPECT_EQ(above.beauty[middle], Rgb(0));
    EXPECT_LT(glm::length(below.beauty[corner] - Rgb(0.25f, 0.5f, 1)), 1e-5f);
    EXPECT_EQ(below.alpha[corner], 0);
    EXPECT_EQ(below.depth[corner], 1e30f);
    FrameOptions options;
    options.background = false;
    Progress progress;
    EXPECT_EQ(renderFrame(relit, fromAbove(), options, progress).beauty[corner], Rgb(0));
}

/// A plane of one glossy lobe of weight 1.
Estimate glossyEstimate(const Scene& scene, float alpha, const Rgb& environment) {
    Estimate estimate = test::matteEstimate(scene, Rgb(0), environment);
    estimate.reflectance.basis.lobes.push_back({Lobe::Kind::ggx, alpha, "ggx"});
    estimate.reflectance.weight.push_back(std::vector<Rgb>(scene.mesh.vertexCount(), Rgb(1)));
    return estimate;
}

TEST(Frame, OfAGlossyPlaneMirrorsTheEmitter) {
    const Scene scene = test::sceneOf(test::sheet({-4, -4, 0}, {8, 0, 0}, {0, 8, 0}, 2, 2));
    // Seen at 45 degrees from -x; the mirror image of the emitter is met at the origin.
    Mat4 facing(1);
    facing[3] = Vec4(2, 0, 2, 1);
    const RelitScene relit = test::relitOf(scene, glossyEstimate(scene, 0.005f, Rgb(0)),
                                           onlyAdded({EmitterShape::rectangle, "lamp", facing, Vec2(1), Rgb(5)}));
    const Frame frame = render(relit, test::cameraAt({-2, 0, 2}, {0, 0, 0}, 33, 33, 60), 16);
    EXPECT_NEAR(frame.beauty[16 * 33 + 16].y, 5, 0.1) << "the light's image has the light's radiance";
    EXPECT_LT(frame.beauty[1 * 33 + 1].y, 0.3f) << "away from the image there is little";
}

TEST(Frame, OfAGlossyPlaneUnderAConstantEnvironmentIsTheAlbedoOfTheLobe) {
    const Scene scene = test::sceneOf(test::sheet({-4, -4, 0}, {8, 0, 0}, {0, 8, 0}, 2, 2));
    for (const float alpha : {0.05f, 0.5f}) {
        const Frame frame = render(test::relitOf(scene, glossyEstimate(scene, alpha, Rgb(1))), fromAbove(16, 100), 16);
        const Lobe lobe{Lobe::Kind::ggx, alpha, ""};
        const DirectionGrid grid{512};
        double albedo = 0;
        for (int c = 0; c < grid.cells(); ++c)
            if (const Vec3 d = grid.direction(c); d.z > 0)
                albedo += double(evaluateLobe(lobe, d, {0, 0, 1})) * d.z * grid.cellSolidAngle();
        EXPECT_NEAR(meanRatio(frame, frame.beauty, [&](const Vec3&) { return albedo; }), 1, 0.01) << alpha;
    }
}

RelitScene clutter() {
    Mesh mesh = test::sheet({-2, -2, 0}, {4, 0, 0}, {0, 4, 0}, 4, 4);
    append(mesh, test::ball({0, 0, 0.5f}, 0.4f, 10, 16));
    const std::vector<uint32_t> emitter = append(mesh, test::squareAbove(0.5f, 1, 1, 2, 2));
    const Scene scene = test::sceneOf(mesh);
    Estimate estimate = test::matteEstimate(scene, Rgb(0.6f, 0.5f, 0.4f), Rgb(0.3f, 0.4f, 0.5f),
                                            test::emittersOf(scene, {emitter}, {Rgb(20, 15, 10)}));
    estimate.reflectance.basis.lobes.push_back({Lobe::Kind::ggxDielectric, 0.2f, "glaze"});
    estimate.reflectance.weight.push_back(std::vector<Rgb>(scene.mesh.vertexCount(), Rgb(1)));
    Look look;
    look.added.push_back({EmitterShape::sphere, "bulb", test::translation({-1, 0.5f, 1}), Vec2(0.2f), Rgb(9, 9, 30)});
    return test::relitOf(scene, estimate, look);
}

TEST(Frame, LightGroupsAddUpToTheBeauty) {
    const RelitScene relit = clutter();
    const Frame frame = render(relit, test::cameraAt({0, -3, 2}, {0, 0, 0.3}, 40, 30, 40), 4);
    ASSERT_EQ(frame.byEmitter.size(), 2u);
    double fromEach[3] = {};
    for (size_t p = 0; p < frame.beauty.size(); ++p) {
        const Rgb sum = frame.world[p] + frame.byEmitter[0][p] + frame.byEmitter[1][p];
        EXPECT_LT(maxChannel(glm::abs(sum - frame.beauty[p])), 1e-5f * (1 + maxChannel(sum)));
        ASSERT_TRUE(isFinite(frame.beauty[p]));
        ASSERT_GE(std::min({frame.beauty[p].x, frame.beauty[p].y, frame.beauty[p].z}), 0);
        fromEach[0] += frame.world[p].y;
        fromEach[1] += frame.byEmitter[0][p].y;
        fromEach[2] += frame.byEmitter[1][p].y;
    }
    for (const double sum : fromEach) EXPECT_GT(sum, 1);
}

TEST(Frame, PixelsAloneHaveTheSameBitsAsInTheWhole) {
    const Scene scene = test::sceneOf(test::sheet({-4, -4, 0}, {8, 0, 0}, {0, 8, 0}, 2, 2));
    const RelitScene relit = test::relitOf(
        scene, test::matteEstimate(scene, Rgb(0.5f), Rgb(1, 2, 3)),
        onlyAdded({EmitterShape::rectangle, "lamp", test::translation({0.5f, 0, 2.5f}), Vec2(0.5f), Rgb(100)}));
    const Camera camera = fromAbove();
    const Frame whole = render(relit, camera);
    Progress progress;
    std::vector<PixelAt> at;
    for (int i = 0; i < camera.width * camera.height; i += 5) at.push_back({i % camera.width, i / camera.width});
    const std::vector<Rgb> some = FrameRenderer(relit, camera, FrameOptions{}).pixels(camera, at, progress);
    ASSERT_EQ(some.size(), at.size());
    for (size_t i = 0; i < at.size(); ++i)
        EXPECT_EQ(some[i], whole.beauty[size_t(at[i].y) * size_t(camera.width) + size_t(at[i].x)]);
}

TEST(Frame, HasTheSameBitsOnOneAndManyThreads) {
    const RelitScene relit = clutter();
    const auto image = [&](int threads) {
        const ThreadLimit limit(threads);
        return render(relit, test::cameraAt({0, -3, 2}, {0, 0, 0.3}, 40, 30, 40), 3).beauty;
    };
    EXPECT_EQ(image(1), image(4));
}

TEST(Frame, DoesNotDependOnHowManyPixelsAreDrawnButOnTheSeed) {
    const RelitScene relit = clutter();
    const Camera camera = test::cameraAt({0, -3, 2}, {0, 0, 0.3}, 40, 30, 40);
    FrameOptions options;
    options.samplesPerPixel = 3;
    Progress progress;
    const auto first = renderFrame(relit, camera, options, progress).beauty;
    EXPECT_EQ(renderFrame(relit, camera, options, progress).beauty, first);
    options.seed = 2;
    EXPECT_NE(renderFrame(relit, camera, options, progress).beauty, first);
}

TEST(Frame, StopsHalfWayWhenAsked) {
    const RelitScene relit = clutter();
    test::expectStopsHalfWay([&](Progress& progress) {
        FrameOptions options;
        options.samplesPerPixel = 32;
        renderFrame(relit, test::cameraAt({0, -3, 2}, {0, 0, 0.3}, 320, 240, 320), options, progress);
    });
}

TEST(FrameRenderer, StripsHaveTheBitsOfTheWholeFrame) {
    const Scene scene = test::sceneOf(test::sheet({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, 4, 4));
    Look look;
    look.added.push_back({EmitterShape::disk, "lamp", test::translation({0, 0, 1}), Vec2(0.5f), Rgb(10)});
    const RelitScene relit = test::relitOf(scene, test::matteEstimate(scene, Rgb(0.5f), Rgb(1)), look);
    const Camera camera = test::cameraAt({0, -2, 1.5}, {0, 0, 0.4}, 37, 29, 30);
    FrameOptions options;
    options.samplesPerPixel = 2;
    Progress progress;
    const Frame whole = renderFrame(relit, camera, options, progress);
    const FrameRenderer renderer(relit, camera, options);
    size_t at = 0, emitterPixels = 0;
    for (const auto& [first, count] : std::vector<std::pair<int, int>>{{0, 7}, {7, 1}, {8, 21}}) {
        const Frame strip = renderer.rows(first, count, progress);
        ASSERT_EQ(strip.height, count);
        for (size_t p = 0; p < strip.beauty.size(); ++p, ++at) {
            ASSERT_EQ(strip.beauty[p], whole.beauty[at]) << at;
            ASSERT_EQ(strip.byEmitter[0][p], whole.byEmitter[0][at]);
            ASSERT_EQ(strip.position[p], whole.position[at]);
            ASSERT_EQ(strip.depth[p], whole.depth[at]);
            ASSERT_EQ(strip.emittersSeen[p][0].fraction, whole.emittersSeen[at][0].fraction);
            emitterPixels += strip.emittersSeen[p][0].fraction == 1;
        }
    }
    EXPECT_EQ(at, whole.beauty.size());
    EXPECT_GT(emitterPixels, 3u);
}

}  // namespace
}  // namespace relamp
