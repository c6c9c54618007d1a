#include "solve/probe/light_probe.h"

#include <gtest/gtest.h>

#include <fstream>
#include <limits>

#include "base/error.h"
#include "image/environment_map.h"
#include "support/temporary_folder.h"

namespace relamp {
namespace {

/// A sky with a window, a warm wall and a dark floor: nothing about it is symmetric.
Rgb probedSky(const Vec3& d) {
    const float window = std::exp(20 * (glm::dot(d, glm::normalize(Vec3(0.3f, 1, 0.2f))) - 1)),
                wall = std::max(0.0f, glm::dot(d, Vec3(-0.8f, 0.6f, 0)));
    return Rgb(0.2f, 0.22f, 0.25f) + 0.1f * d.z + Rgb(5, 5.5f, 6) * window + Rgb(0.6f, 0.4f, 0.2f) * wall;
}

Image latLongOf(Rgb (*sky)(const Vec3&), int width) {
    Image image(width, width / 2);
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < width; ++x)
            image.at(x, y) =
                sky(directionFromLatLong({(float(x) + 0.5f) / float(width), (float(y) + 0.5f) / float(image.height)}));
    return image;
}

/// Photographs that show the sky between two heights.
RadianceSamples backgroundOf(Rgb (*sky)(const Vec3&), float low, float high, const Mat3& axes = Mat3(1)) {
    RadianceSamples samples;
    samples.backgroundGrid.axes = axes;
    const DirectionGrid& grid = samples.backgroundGrid;
    samples.background.assign(size_t(grid.cells()), Rgb(0));
    samples.backgroundPixels.assign(size_t(grid.cells()), 0);
    samples.backgroundClipped.assign(size_t(grid.cells()), 0);
    for (int c = 0; c < grid.cells(); ++c) {
        const Vec3 d = grid.direction(c);
        if (d.z < low || d.z > high) continue;
        samples.background[size_t(c)] = sky(d);
        samples.backgroundPixels[size_t(c)] = 9;
    }
    return samples;
}

TEST(LightProbe, ItsYawAndGainAreFoundFromTheBackground) {
    const Mat3 axes = frameAround(glm::normalize(Vec3(1, 2, 3)));
    for (const float yaw : {73.4f, -140.2f}) {
        LightProbe probe;
        probe.name = "set.exr";
        probe.latLong = yawed(latLongOf(probedSky, 256), -yaw);
        const Rgb exposure(0.37f, 0.4f, 0.33f);
        for (Rgb& p : probe.latLong.pixels) p *= exposure;
        const RadianceSamples samples = backgroundOf(probedSky, -0.4f, 0.3f, axes);
        ProbeFit fit = fitToBackground(probe, samples);
        judge(fit);
        EXPECT_EQ(fit.by, "background");
        EXPECT_TRUE(fit.used);
        EXPECT_FALSE(fit.doubtful()) << fit.words;
        EXPECT_NEAR(fit.yawDegrees, yaw, 0.2f);
        EXPECT_LT(fit.yawSigma, 0.5f);
        for (int c = 0; c < 3; ++c) EXPECT_NEAR(fit.gain[c] * exposure[c], 1, 0.01f);
        EXPECT_NEAR(fit.compared, 0.35f, 0.02f);  // a zone's part of the sphere is half its height
        EXPECT_FLOAT_EQ(fit.held, 1);
        // By that fit it is the sky again, in directions that no photograph shows too.
        const FittedProbe fitted = fittedProbe(probe, fit, axes);
        double off = 0;
        for (int c = 0; c < fitted.grid.cells(); ++c) {
            const Rgb truth = probedSky(fitted.grid.direction(c));
            off += double(maxChannel(glm::abs(fitted.radiance[size_t(c)] / truth - 1.0f)));
        }
        EXPECT_LT(off / fitted.grid.cells(), 0.02);
    }
}

TEST(LightProbe, OfAnotherPlaceIsNoticedAndLeftOut) {
    LightProbe probe;
    probe.name = "elsewhere.exr";
    probe.latLong = latLongOf(
        [](const Vec3& d) {
            return std::sin(9 * d.x) * std::cos(7 * d.y + 2 * d.z) > 0 ? Rgb(3, 2, 0.5f) : Rgb(0.1f, 0.2f, 0.4f);
        },
        256);
    ProbeFit fit = fitToBackground(probe, backgroundOf(probedSky, -0.5f, 0.5f));
    judge(fit);
    EXPECT_GT(fit.noise, ProbeFit::mostNoise);
    EXPECT_FALSE(fit.used);
    EXPECT_TRUE(fit.doubtful());
    EXPECT_NE(fit.words.find("elsewhere.exr: does not show the light"), std::string::npos) << fit.words;
}

TEST(LightProbe, WithRoughTexelsHasAsMuchNoise) {
    LightProbe probe;
    probe.latLong = latLongOf(probedSky, 256);
    // Patches of 11 degrees that are a quarter too bright or too dark.
    for (int y = 0; y < 128; ++y)
        for (int x = 0; x < 256; ++x) probe.latLong.at(x, y) *= (x / 8 * 7 + y / 8 * 5) % 3 == 0 ? 1.25f : 0.8f;
    ProbeFit fit = fitToBackground(probe, backgroundOf(probedSky, -0.6f, 0.6f));
    judge(fit);
    EXPECT_NEAR(fit.yawDegrees, 0, 1);
    EXPECT_GT(fit.noise, 0.08f);
    EXPECT_LT(fit.noise, 0.4f);
    EXPECT_TRUE(fit.used);
}

TEST(LightProbe, WithoutBackgroundNothingTellsHowItIsTurned) {
    LightProbe probe;
    probe.name = "set.exr";
    probe.latLong = latLongOf(probedSky, 128);
    ProbeFit fit = fitToBackground(probe, backgroundOf(probedSky, 2, 3));
    judge(fit);
    EXPECT_EQ(fit.by, "");
    EXPECT_FALSE(fit.used);
    EXPECT_NE(fit.words.find("too little background"), std::string::npos);
    // A mirror ball's camera tells; only its exposure is then unknown.
    probe.aligned = true;
    fit = fitToBackground(probe, backgroundOf(probedSky, 2, 3));
    judge(fit);
    EXPECT_EQ(fit.by, "camera");
    EXPECT_TRUE(fit.used);
    EXPECT_EQ(fit.gainSigma, 0);
}

TEST(LightProbe, DirectionsThatItDoesNotHoldSayNothing) {
    LightProbe probe;
    probe.aligned = true;
    probe.latLong = latLongOf(probedSky, 256);
    probe.latLong.usable.assign(probe.latLong.pixels.size(), 1);
    for (int y = 0; y < 128; ++y)
        for (int x = 0; x < 64; ++x) {
            probe.latLong.usable[size_t(y * 256 + x)] = 0;
            probe.latLong.at(x, y) = Rgb(100);
        }
    const ProbeFit fit = fitToBackground(probe, backgroundOf(probedSky, -0.5f, 0.5f));
    EXPECT_NEAR(fit.held, 0.75f, 0.01f);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(fit.gain[c], 1, 0.01f);
    const FittedProbe fitted = fittedProbe(probe, fit, Mat3(1));
    const LightLeaves leaves = LightLeaves::uniform(3);
    const ProbeAnchor anchor = probeAnchor(fitted, leaves);
    const size_t out = leaves.leafOf(directionFromLatLong({0.1f, 0.5f})),
                 in = leaves.leafOf(directionFromLatLong({0.6f, 0.5f}));
    EXPECT_LT(anchor.held[out], 0.1f);
    EXPECT_FLOAT_EQ(anchor.held[in], 1);
    for (size_t i = 0; i < leaves.size(); ++i) EXPECT_LT(maxChannel(anchor.radiance[i]), 20);
}

TEST(LightProbe, ClippedTexelsAreNotHeld) {
    Image sky = latLongOf(probedSky, 128), clipped = sky, even = sky;
    EXPECT_EQ(leaveOutClipped(sky), 0u) << "the peak of a window is no plateau";
    constexpr float level = 2;
    size_t above = 0;
    for (Rgb& p : clipped.pixels) {
        above += maxChannel(p) >= level;
        p = glm::min(p, Rgb(level));
    }
    ASSERT_GT(above, 20u);
    EXPECT_EQ(leaveOutClipped(clipped), above);
    for (size_t i = 0; i < clipped.pixels.size(); ++i)
        EXPECT_EQ(clipped.usable[i], maxChannel(clipped.pixels[i]) < level ? 1 : 0);
    for (Rgb& p : even.pixels) p = Rgb(1);
    EXPECT_EQ(leaveOutClipped(even), 0u) << "an even environment is not clipped";
}

TEST(LightProbe, FilesThatAreNoneAreErrorsThatNameThem) {
    const test::TemporaryFolder folder;
    const auto expectError = [&](const std::string& name, const std::string& word) {
        try {
            readLightProbe(folder / name);
            ADD_FAILURE() << name << " was read";
        } catch (const Error& error) {
            EXPECT_NE(std::string(error.what()).find(name), std::string::npos) << error.what();
            EXPECT_NE(std::string(error.what()).find(word), std::string::npos) << error.what();
        }
    };
    expectError("missing.exr", "");
    writeImage(folder / "square.exr", Image(64, 64, Rgb(1)));
    expectError("square.exr", "twice as wide as high");
    writeImage(folder / "tiny.exr", Image(8, 4, Rgb(1)));
    expectError("tiny.exr", "16 x 8 at least");
    writeImage(folder / "black.exr", Image(64, 32, Rgb(0)));
    expectError("black.exr", "holds no light");
    Image bad(64, 32, Rgb(1));
    for (int x = 0; x < 64 * 8; ++x) bad.pixels[size_t(x)] = Rgb(std::numeric_limits<float>::quiet_NaN());
    writeImage(folder / "nan.exr", bad);
    expectError("nan.exr", "25 % of its texels are not finite");
    writeImage(folder / "whole.exr", latLongOf(probedSky, 256));
    const std::string bytes = test::TemporaryFolder::read(folder / "whole.exr");
    folder.write("truncated.exr", bytes.substr(0, bytes.size() / 2));
    expectError("truncated.exr", "");
    folder.write("text.hdr", "no image");
    expectError("text.hdr", "");
    // A few texels that are not finite are not held.
    Image few = latLongOf(probedSky, 64);
    few.at(3, 4) = Rgb(std::numeric_limits<float>::infinity());
    writeImage(folder / "few.exr", few);
    const LightProbe probe = readLightProbe(folder / "few.exr");
    EXPECT_FALSE(probe.latLong.usableAt(3, 4));
    EXPECT_TRUE(probe.latLong.usableAt(4, 4));
}

}  // namespace
}  // namespace relamp
