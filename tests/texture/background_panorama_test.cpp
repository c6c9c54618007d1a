#include "texture/background_panorama.h"

#include <gtest/gtest.h>

#include "radiance/gather.h"
#include "support/estimates.h"

namespace relamp {
namespace {

/// Stripes of four degrees, finer than the cells below.
Rgb stripes(const Vec3& d) {
    const float azimuth = std::atan2(d.y, d.x) * 180 / pi;
    return std::sin(azimuth * 2 * pi / 4) > 0 ? Rgb(2, 1, 0.5f) : Rgb(0.5f);
}

class BackgroundPanorama : public testing::Test {
protected:
    BackgroundPanorama() : scene(test::sceneOf(test::sheet({-0.3f, -0.3f, 0}, {0.6f, 0, 0}, {0, 0.6f, 0}, 4, 4))) {
        for (int i = 0; i < 8; ++i) addView(i * piD / 4);
    }
    void addView(double a) {
        View view = test::photographOf(
            scene, test::cameraAt({3 * std::cos(a), 3 * std::sin(a), 0.6}, {0, 0, 0.3}, 160, 100, 150),
            [](const Hit&) { return Rgb(50); });
        for (int y = 0; y < view.camera.height; ++y)
            for (int x = 0; x < view.camera.width; ++x) {
                const Vec3 d = view.camera.rayDirection(Vec2(x, y) + 0.5f);
                if (!scene.cameraTracer->closest({Vec3(view.camera.position()), d, 0, 1e30f}))
                    view.image.at(x, y) = stripes(d);
            }
        capture.views.push_back(std::move(view));
    }
    std::shared_ptr<const Panorama> panorama(int environment = 0) {
        Progress progress;
        samples = gatherRadiance(capture, scene, {}, progress);
        const std::vector<Rgb> cells(size_t(grid.cells()), Rgb(0.9f));
        return backgroundPanorama(capture, samples, environment, cells, grid, progress);
    }

    Scene scene;
    Capture capture;
    RadianceSamples samples;
    DirectionGrid grid{64};
};

TEST_F(BackgroundPanorama, IsAsFineAsThePhotographs) {
    const auto found = panorama();
    ASSERT_TRUE(found);
    EXPECT_EQ(found->width(), 1024);
    int right = 0, all = 0;
    for (float azimuth = 0.5f; azimuth < 360; azimuth += 1) {
        const float a = azimuth * pi / 180;
        const Vec3 d = glm::normalize(Vec3(std::cos(a), std::sin(a), 0.05f));
        ++all;
        right += glm::length(found->radiance(d) - stripes(d)) < 0.25f;
    }
    EXPECT_GT(right, 0.9 * all) << "of " << all;
}

TEST_F(BackgroundPanorama, ShowsNothingOfTheMeshAndGoesOverIntoTheCells) {
    const auto found = panorama();
    ASSERT_TRUE(found);
    for (const Rgb& texel : found->image().pixels) ASSERT_LT(texel.x, 2.01f) << "the sheet is at 50";
    EXPECT_LT(glm::length(found->radiance({0, 0, 1}) - Rgb(0.9f)), 0.02f) << "nobody looked up";
    EXPECT_LT(glm::length(found->radiance({0, 0, -1}) - Rgb(0.9f)), 0.1f);
}

TEST_F(BackgroundPanorama, TakesTheCellsWhereAPhotographIsClipped) {
    for (View& view : capture.views) {
        view.saturation = 0.5f;
        for (Rgb& pixel : view.image.pixels) pixel = Rgb(0.5f);
    }
    const auto found = panorama();
    ASSERT_TRUE(found);
    EXPECT_NEAR(found->radiance({1, 0, 0.05f}).x, 0.9, 2e-3);
}

TEST_F(BackgroundPanorama, LeavesOutViewsOfOtherEnvironments) {
    capture.states = {"day", "night"};
    capture.environmentOfState = {0, 1};
    for (size_t i = 0; i < 4; ++i) {
        capture.views[i].state = 1;
        for (Rgb& pixel : capture.views[i].image.pixels) pixel = Rgb(9);
    }
    const auto day = panorama(0), night = panorama(1);
    ASSERT_TRUE(day && night);
    for (const Rgb& texel : day->image().pixels) ASSERT_LT(texel.x, 2.01f);
    float most = 0;
    for (const Rgb& texel : night->image().pixels) most = std::max(most, texel.x);
    EXPECT_NEAR(most, 9, 0.05);
}

TEST_F(BackgroundPanorama, IsNoneWhereNobodySeesPastTheMesh) {
    scene = test::sceneOf(test::sheet({-9, -9, -1}, {18, 0, 0}, {0, 18, 0}, 4, 4));
    capture.views.clear();
    View view = test::photographOf(scene, test::cameraAt({0, 0.1, 3}, {0, 0, 0}, 60, 40, 60),
                                   [](const Hit&) { return Rgb(1); });
    capture.views.push_back(std::move(view));
    EXPECT_FALSE(panorama());
}

}  // namespace
}  // namespace relamp
