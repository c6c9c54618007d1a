// Exposures, white balance and fall-off put into a world's photographs are found again; where there are none nothing is
// done.
#include "solve/photometric_estimate.h"

#include <gtest/gtest.h>

#include "base/parallel.h"
#include "capture/load_capture.h"
#include "radiance/gather.h"
#include "support/known_world.h"

namespace relamp {
namespace {

struct Photographed {
    Capture capture;
    Scene scene;

    Photographed() {
        const test::TemporaryFolder folder;
        test::paintKnownWorld(folder.path(), true, 6, 16);
        Progress progress;
        capture = loadCapture(folder.path(), {}, progress);
        scene = buildScene(capture.mesh, progress);
    }
    PhotometricEstimate estimate(int threads = 0) const {
        const ThreadLimit limit(threads);
        Progress progress;
        return estimatePhotometric(capture, scene, gatherRadiance(capture, scene, {}, progress), progress);
    }
};

/// What automatic cameras do: exposures 20 % apart, white balance 5 %, corners a quarter darker.
PhotometricFix automatic(const Capture& capture) {
    PhotometricFix fix;
    const float exposure[6] = {0.2f, -0.1f, 0.15f, -0.2f, 0.05f, -0.1f},
                balance[6] = {0.05f, 0, -0.05f, 0.02f, -0.04f, 0.02f};
    for (size_t i = 0; i < 6; ++i)
        fix.gains.push_back(
            {capture.views[i].name, glm::exp(Rgb(exposure[i] + balance[i], exposure[i], exposure[i] - balance[i]))});
    fix.falloff2 = -0.2f;
    fix.falloff4 = -0.1f;
    return fix;
}

/// The fix that undoes another.
PhotometricFix inverse(PhotometricFix fix) {
    for (auto& g : fix.gains) g.gain = 1.0f / g.gain;
    fix.falloff2 *= -1;
    fix.falloff4 *= -1;
    return fix;
}

TEST(PhotometricEstimate, LeavesPhotographsOfOneExposureAlone) {
    const PhotometricEstimate found = Photographed().estimate();
    EXPECT_FALSE(found.needed()) << toText(found);
    EXPECT_LT(found.gainRms, 0.005f);
}

TEST(PhotometricEstimate, FindsGainsAndFalloffOfAnAutomaticCamera) {
    Photographed p;
    const PhotometricFix put = automatic(p.capture);
    for (View& view : p.capture.views) applyPhotometric(inverse(put), view);
    const PhotometricEstimate found = p.estimate();
    EXPECT_TRUE(found.needed()) << toText(found);
    ASSERT_EQ(found.fix.gains.size(), 6u);
    for (size_t i = 0; i < 6; ++i)
        EXPECT_LT(maxChannel(glm::abs(glm::log(found.fix.gains[i].gain / put.gains[i].gain))), 0.015f) << i;
    EXPECT_NEAR(found.fix.falloffAt(1), put.falloffAt(1), 0.03f);
    EXPECT_NEAR(found.fix.falloffAt(0.5f), put.falloffAt(0.5f), 0.015f);
    // With it taken out nothing is left to do.
    for (View& view : p.capture.views) applyPhotometric(found.fix, view);
    EXPECT_FALSE(p.estimate().needed());
}

TEST(PhotometricEstimate, HasTheSameBitsOnOneAndManyThreads) {
    const Photographed p;
    EXPECT_EQ(p.estimate(1).fix, p.estimate().fix);
}

TEST(PhotometricFix, DividesGainAndFalloffOutAndKeepsClippedPixelsClipped) {
    View view;
    view.name = "a";
    view.camera = test::cameraAt({0, 0, 3}, {0, 0, 0}, 40, 30, 30, {0, 1, 0});
    view.image = Image(40, 30, Rgb(0.6f, 0.3f, 0.15f));
    view.image.at(0, 0) = Rgb(1);
    view.image.at(20, 15) = Rgb(1);
    view.saturation = 0.99f;
    const PhotometricFix fix{{{"b", Rgb(9)}, {"a", Rgb(2, 1, 0.5f)}}, -0.5f, 0};
    applyPhotometric(fix, view);
    EXPECT_EQ(radiusSquared(view.camera, Vec2(20, 15)), 0);
    EXPECT_NEAR(radiusSquared(view.camera, Vec2(0, 30)), 1, 1e-6f);
    const float r2 = radiusSquared(view.camera, Vec2(10.5f, 7.5f)), open = std::exp(-0.5f * r2);
    EXPECT_LT(glm::length(view.image.at(10, 7) - Rgb(0.3f, 0.3f, 0.3f) / open), 1e-5f);
    EXPECT_GE(maxChannel(view.image.at(0, 0)), view.saturation);
    EXPECT_GE(maxChannel(view.image.at(20, 15)), view.saturation);
    EXPECT_LT(maxChannel(view.image.at(19, 14)), 0.8f);
}

}  // namespace
}  // namespace relamp
