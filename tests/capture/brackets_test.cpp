#include "capture/brackets.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <numeric>

#include "base/error.h"
#include "base/parallel.h"
#include "base/random.h"
#include "capture/load_capture.h"
#include "support/stopping.h"
#include "support/temporary_folder.h"

namespace relamp {
namespace {

/// A camera that is neither sRGB nor a power: per channel p (1 + k) / (p + k) with p = X^gamma.
struct KnownCamera {
    std::array<double, 3> gamma{0.58, 0.62, 0.55};
    double knee = 0.8;

    double code(int channel, double exposure) const {
        const double p = std::pow(std::clamp(exposure, 0.0, 1.0), gamma[size_t(channel)]);
        return 255 * p * (1 + knee) / (p + knee);
    }
    double exposure(int channel, double code) const {
        const double z = code / 255;
        return std::pow(knee * z / (1 + knee - z), 1 / gamma[size_t(channel)]);
    }
};

/// Gaussian noise from four uniform numbers.
double noise(uint64_t a, uint64_t b) {
    double sum = -2;
    for (uint64_t k = 0; k < 4; ++k) sum += double(unitFloat(mixBits(mixBits(a) ^ (b * 4 + k))));
    return sum * 1.732;
}

/// Radiance over four decades with a colour that changes, smooth.
Rgb radianceAt(int x, int y, int width, int height) {
    const float u = float(x) / float(width - 1), v = float(y) / float(height - 1);
    const float brightness = std::pow(10.0f, -2.5f + 4.0f * u);
    return brightness * Rgb(0.7f + 0.5f * v, 0.9f, 1.1f - 0.5f * v);
}

struct PhotographedWorld {
    std::vector<double> times{0.004, 1 / 60.0, 1 / 15.0, 0.25, 1};
    std::vector<CodeImage> images;
    Image truth;

    explicit PhotographedWorld(const KnownCamera& camera = {}, int width = 192, int height = 96, double scale = 1)
        : truth(width, height) {
        for (int y = 0; y < height; ++y)
            for (int x = 0; x < width; ++x) truth.at(x, y) = float(scale) * radianceAt(x, y, width, height);
        for (size_t i = 0; i < times.size(); ++i) images.push_back(photograph(camera, times[i], i));
    }
    CodeImage photograph(const KnownCamera& camera, double time, uint64_t seed) const {
        CodeImage image{truth.width, truth.height, false, std::vector<uint16_t>(truth.pixels.size() * 3)};
        for (size_t p = 0; p < truth.pixels.size(); ++p)
            for (int c = 0; c < 3; ++c) {
                const double x = double(truth.pixels[p][c]) * time;
                const double noisy = x + std::sqrt(0.004 * 0.004 * std::min(x, 1.0) + 0.0006 * 0.0006) *
                                             noise(seed, p * 3 + uint64_t(c));
                image.codes[p * 3 + size_t(c)] = uint16_t(257 * std::lround(camera.code(c, noisy)));
            }
        return image;
    }
    ResponseCurve response(double smoothness = 1) const {
        return fitResponse(sampleBracket(images, times, 3000), smoothness);
    }
};

/// Median over the pixels of |a / b - 1|, one scale a channel taken out; pixels clipped in the shortest exposure left
/// out.
double medianError(const MergedBracket& merged, const PhotographedWorld& world) {
    double worst = 0;
    for (int c = 0; c < 3; ++c) {
        std::vector<double> ratios;
        for (size_t p = 0; p < world.truth.pixels.size(); ++p)
            if (!merged.clipped[p])
                ratios.push_back(double(merged.image.pixels[p][c]) / double(world.truth.pixels[p][c]));
        const auto median = [](std::vector<double>& v) {
            std::nth_element(v.begin(), v.begin() + std::ptrdiff_t(v.size() / 2), v.end());
            return v[v.size() / 2];
        };
        const double scale = median(ratios);
        for (double& r : ratios) r = std::abs(r / scale - 1);
        worst = std::max(worst, median(ratios));
    }
    return worst;
}

TEST(Brackets, TheResponseOfAKnownCameraIsFound) {
    const PhotographedWorld world;
    const KnownCamera camera;
    const ResponseCurve curve = world.response();
    for (int c = 0; c < 3; ++c) {
        EXPECT_EQ(curve.logExposure[size_t(c)][255], 0);
        double squares = 0, mean = 0;
        int count = 0;
        for (int z = 8; z <= 248; ++z, ++count)
            mean += curve.logExposure[size_t(c)][size_t(z)] - std::log(camera.exposure(c, z));
        mean /= count;
        for (int z = 8; z <= 248; ++z) {
            const double d = curve.logExposure[size_t(c)][size_t(z)] - std::log(camera.exposure(c, z)) - mean;
            squares += d * d;
        }
        EXPECT_LT(std::sqrt(squares / count), 0.05) << c;
        EXPECT_LT(std::abs(mean), 0.12) << c;  // full scale is exposure 1 in every channel
    }
    EXPECT_GT(curve.samples, 1000u);
}

TEST(Brackets, CurvesNeverFallAndInvert) {
    const ResponseCurve curve = PhotographedWorld().response();
    for (int c = 0; c < 3; ++c) {
        for (size_t z = 1; z < 256; ++z)
            EXPECT_GE(curve.logExposure[size_t(c)][z], curve.logExposure[size_t(c)][z - 1]);
        for (double z = 5; z < 250; z += 7.3) EXPECT_NEAR(curve.code(c, curve.exposure(c, z)), z, 1e-6);
        EXPECT_EQ(curve.code(c, 0), 0);
        EXPECT_EQ(curve.code(c, 5), 255);
    }
}

TEST(Brackets, MergedRadianceIsTheWorldsWithinItsNoise) {
    const PhotographedWorld world;
    Progress progress;
    const MergedBracket merged = mergeCodes(world.images, world.times, world.response(), {}, progress);
    EXPECT_LT(medianError(merged, world), 0.03);
    EXPECT_EQ(merged.ghosts, 0u);
}

TEST(Brackets, ALinearCameraIsUsedAsItIsAndTheScaleIsFullScaleAtOneSecond) {
    CodeImage dim{1, 1, true, {6553, 13107, 26214}}, bright{1, 1, true, {26214, 52428, 65535}};
    Progress progress;
    const MergedBracket merged = mergeCodes({dim, bright}, {0.5, 2}, linearResponse(), {}, progress);
    EXPECT_NEAR(merged.image.at(0, 0).x, 0.2f, 1e-4);
    EXPECT_NEAR(merged.image.at(0, 0).y, 0.4f, 1e-4);
    EXPECT_NEAR(merged.image.at(0, 0).z, 0.8f, 1e-4);  // clipped in the longer one only
    EXPECT_FALSE(merged.clipped[0]);
    EXPECT_NEAR(merged.saturation, 2 * 250 / 255.0, 1e-3);
}

TEST(Brackets, ClippedInTheShortestIsFlaggedAndALowerBound) {
    PhotographedWorld world;
    world.truth.at(30, 40) = Rgb(400);  // 1.6 at the shortest
    world.images.clear();
    for (size_t i = 0; i < world.times.size(); ++i) world.images.push_back(world.photograph({}, world.times[i], i));
    Progress progress;
    const MergedBracket merged = mergeCodes(world.images, world.times, world.response(), {}, progress);
    const size_t p = size_t(40) * 192 + 30;
    EXPECT_TRUE(merged.clipped[p]);
    EXPECT_GE(maxChannel(merged.image.pixels[p]), merged.saturation);
    EXPECT_NEAR(merged.saturation, 1 / 0.004, 25);
    for (size_t q = 0; q < merged.clipped.size(); ++q)
        EXPECT_EQ(maxChannel(merged.image.pixels[q]) >= merged.saturation, merged.clipped[q] != 0);
}

TEST(Brackets, WhatMovedIsFlaggedLeftOutAndShownOnce) {
    PhotographedWorld world;
    const ResponseCurve curve = world.response();
    // A grey card over a mid-tone patch, in one exposure only.
    for (int y = 30; y < 50; ++y)
        for (int x = 90; x < 110; ++x)
            for (size_t c = 0; c < 3; ++c) world.images[2].codes[(size_t(y) * 192 + size_t(x)) * 3 + c] = 120 * 257;
    Progress progress;
    const MergedBracket merged = mergeCodes(world.images, world.times, curve, {}, progress);
    size_t inside = 0;
    for (int y = 31; y < 49; ++y)
        for (int x = 91; x < 109; ++x) inside += merged.ghost[size_t(y) * 192 + size_t(x)];
    EXPECT_EQ(inside, 18u * 18u);
    EXPECT_LE(merged.ghosts, 20u * 20u);
    EXPECT_FALSE(merged.image.usableAt(100, 40));
    EXPECT_TRUE(merged.image.usableAt(80, 40));
    const Rgb ratio = merged.image.at(100, 40) / world.truth.at(100, 40),
              beside = merged.image.at(80, 40) / world.truth.at(80, 40);
    EXPECT_NEAR(ratio.y / beside.y, 1, 0.1);
    BracketOptions keep;
    keep.rejectGhosts = false;
    EXPECT_EQ(mergeCodes(world.images, world.times, curve, keep, progress).ghosts, 0u);
}

/// A wall of blocks with sharp edges, as a camera at (dx, dy) sees it.
PhotographedWorld blockWorld(const std::vector<PixelShift>& shifts) {
    PhotographedWorld world({}, 240, 160);
    const Image around = [] {
        Image wide(300, 220);
        for (int y = 0; y < wide.height; ++y)
            for (int x = 0; x < wide.width; ++x) {
                const uint64_t block = mixBits(uint64_t(x / 9) * 7919 + uint64_t(y / 7));
                wide.at(x, y) = Rgb(0.05f + 4 * unitFloat(block) * unitFloat(mixBits(block))) * Rgb(1, 0.8f, 0.6f);
            }
        return wide;
    }();
    const auto cut = [&](const PixelShift& s) {
        Image image(world.truth.width, world.truth.height);
        for (int y = 0; y < image.height; ++y)
            for (int x = 0; x < image.width; ++x) image.at(x, y) = around.at(x + 30 - s.x, y + 30 - s.y);
        return image;
    };
    for (size_t i = 0; i < world.times.size(); ++i) {
        world.truth = cut(shifts[i]);
        world.images[i] = world.photograph({}, world.times[i], i);
    }
    world.truth = cut({});
    return world;
}

TEST(RegisterBracket, FindsTheShiftsOfHandHeldExposures) {
    const std::vector<PixelShift> shifts{{6, -4}, {-3, 5}, {0, 0}, {2, 7}, {-8, -1}};
    const PhotographedWorld world = blockWorld(shifts);
    EXPECT_EQ(bracketShifts(world.images, world.times, 2), shifts);
}

TEST(RegisterBracket, LeavesATripodsExposuresAlone) {
    const PhotographedWorld world = blockWorld(std::vector<PixelShift>(5));
    EXPECT_EQ(bracketShifts(world.images, world.times, 2), std::vector<PixelShift>(5));
    const PhotographedWorld smooth;
    EXPECT_EQ(bracketShifts(smooth.images, smooth.times, 2), std::vector<PixelShift>(5));
}

TEST(RegisterBracket, ShiftedExposuresMergeAsWellAsStillOnes) {
    const std::vector<PixelShift> shifts{{6, -4}, {-3, 5}, {0, 0}, {2, 7}, {-8, -1}};
    const PhotographedWorld still = blockWorld(std::vector<PixelShift>(5)), moved = blockWorld(shifts);
    const ResponseCurve curve = still.response();
    Progress progress;
    BracketOptions keep;
    keep.rejectGhosts = false;
    const auto merge = [&](const PhotographedWorld& world, bool align) {
        std::vector<CodeImage> images = world.images;
        const std::vector<PixelShift> found = align ? bracketShifts(images, world.times, 2) : std::vector<PixelShift>{};
        for (size_t i = 0; i < found.size(); ++i) images[i] = shifted(images[i], found[i]);
        return mergeCodes(images, world.times, curve, keep, progress, found);
    };
    const auto meanError = [](const MergedBracket& merged, const PhotographedWorld& world) {
        double sum = 0, count = 0;
        for (size_t p = 0; p < world.truth.pixels.size(); ++p)
            if (!merged.clipped[p])
                sum += std::abs(std::log(double(merged.image.pixels[p].y) / double(world.truth.pixels[p].y))), ++count;
        return sum / count;
    };
    const MergedBracket good = merge(still, true), aligned = merge(moved, true), crossed = merge(moved, false);
    EXPECT_LT(meanError(aligned, moved), 1.1 * meanError(good, still) + 1e-3);
    EXPECT_GT(meanError(crossed, moved), 5 * meanError(aligned, moved));
    EXPECT_LT(aligned.misfit, 0.02f);
    EXPECT_GT(crossed.misfit, 0.3f);
}

TEST(RegisterBracket, WhatAnExposureDoesNotShowIsNotDark) {
    // Only the long exposure sees the dark rim well, and it is shifted away there: the others say what is there.
    const std::vector<PixelShift> shifts{{0, 0}, {0, 0}, {0, 0}, {0, 0}, {8, 0}};
    const PhotographedWorld world = blockWorld(shifts);
    std::vector<CodeImage> images = world.images;
    images[4] = shifted(images[4], shifts[4]);
    Progress progress;
    const MergedBracket merged = mergeCodes(images, world.times, world.response(), {}, progress, shifts);
    for (int y = 0; y < 160; ++y)
        for (int x = 232; x < 240; ++x) {
            const size_t p = size_t(y) * 240 + size_t(x);
            EXPECT_FALSE(merged.ghost[p]);
            EXPECT_GT(merged.image.pixels[p].y, 0.6f * world.truth.pixels[p].y);
        }
}

TEST(Brackets, SameBitsOnOneAndManyThreads) {
    const PhotographedWorld world;
    const auto run = [&](int threads) {
        const ThreadLimit limit(threads);
        Progress progress;
        return mergeCodes(world.images, world.times, world.response(), {}, progress);
    };
    const MergedBracket one = run(1), many = run(4);
    EXPECT_EQ(one.image.pixels, many.image.pixels);
    EXPECT_EQ(one.ghost, many.ghost);
}

TEST(Brackets, ExposuresThatTellNothingAreRefused) {
    PhotographedWorld world;
    EXPECT_EQ(test::messageOf([&] {
                  fitResponse(sampleBracket(world.images, {1, 1, 1, 1, 1}, 500));
              }),
              "the exposures do not differ, expected brackets of different exposure times");
    for (CodeImage& p : world.images) std::fill(p.codes.begin(), p.codes.end(), uint16_t(0));
    EXPECT_THROW(fitResponse(sampleBracket(world.images, world.times, 500)), Error);
    for (CodeImage& p : world.images) std::fill(p.codes.begin(), p.codes.end(), uint16_t(65535));
    EXPECT_THROW(fitResponse(sampleBracket(world.images, world.times, 500)), Error);
    EXPECT_THROW(fitResponse({}), Error);
}

TEST(Brackets, ApertureAndSensitivityCountAgainstTheFirst) {
    ExposureReference reference;
    EXPECT_DOUBLE_EQ(bracketPhoto("a.jpg", {0.5, 8, 100}, reference).exposure, 0.5);
    EXPECT_DOUBLE_EQ(bracketPhoto("b.jpg", {0.5, 4, 200}, reference).exposure, 4);
    EXPECT_DOUBLE_EQ(bracketPhoto("c.jpg", {0.25, 0, 0}, reference).exposure, 0.25);
    EXPECT_EQ(test::messageOf([&] {
                  bracketPhoto("d.jpg", {0, 8, 100}, reference);
              }),
              "d.jpg: its exposure time is not given, and its EXIF has none");
}

/// Two views of one wall, the second three times as bright, as brackets of 8-bit files.
class BracketCapture : public testing::Test {
protected:
    void SetUp() override {
        folder.write("mesh.obj", "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nf 1 2 3 4\n");
        std::filesystem::create_directories(folder / "images");
        file = {{"w", 96}, {"h", 64}, {"fl_x", 90}, {"frames", nlohmann::json::array()}};
        for (int v = 0; v < 2; ++v) {
            const PhotographedWorld world({}, 96, 64, v ? 3 : 1);
            nlohmann::json exposures = nlohmann::json::array();
            for (size_t i = 0; i < world.times.size(); ++i) {
                const std::string name = fmt::format("images/{}-{}.png", v, i);
                Image image(96,
                            64);  // written through the sRGB curve, so decoded first: the file then holds the codes
                for (size_t p = 0; p < image.pixels.size(); ++p)
                    for (size_t c = 0; c < 3; ++c)
                        image.pixels[p][int(c)] = srgbDecode(float(world.images[i].codes[p * 3 + c]) / 65535);
                writeImage(folder / name, image);
                exposures.push_back({{"file_path", name}, {"exposure_time", world.times[i]}});
            }
            file["frames"].push_back({{"file_path", fmt::format("images/{}-2.png", v)},
                                      {"exposures", exposures},
                                      {"transform_matrix", {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 2}, {0, 0, 0, 1}}}});
        }
    }
    Capture load(const CaptureFix& fix = {}) {
        folder.write("transforms.json", file.dump());
        LoadOptions options;
        options.fix = fix;
        Progress progress;
        return loadCapture(folder.path(), options, progress);
    }
    std::string error(const CaptureFix& fix = {}) {
        return test::messageOf([&] { load(fix); });
    }
    test::TemporaryFolder folder;
    nlohmann::json file;
};

TEST_F(BracketCapture, ViewsShareOneScale) {
    const Capture capture = load();
    // The same place is three times as bright in the second view.
    std::vector<float> ratios;
    for (int y = 8; y < 56; ++y)
        for (int x = 20; x < 70; ++x)
            ratios.push_back(capture.views[1].image.at(x, y).y / capture.views[0].image.at(x, y).y);
    std::nth_element(ratios.begin(), ratios.begin() + 1200, ratios.end());
    EXPECT_NEAR(ratios[1200], 3, 0.05);
    EXPECT_GT(capture.views[0].saturation, 100);
    EXPECT_EQ(capture.views[0].saturation, capture.views[1].saturation);
    EXPECT_NE(capture.notes[0].find("one response curve for all views"), std::string::npos);
}

TEST_F(BracketCapture, FilePathMayBeLeftOut) {
    for (auto& frame : file["frames"]) frame.erase("file_path");
    EXPECT_EQ(load().views[1].name, "images/1-0.png");
}

TEST_F(BracketCapture, AnHdrImageIsReadInsteadUnlessBracketsAreAskedFor) {
    for (int v = 0; v < 2; ++v) {
        writeImage(folder / fmt::format("images/{}.exr", v), Image(96, 64, Rgb(0.25f)));
        file["frames"][size_t(v)]["file_path"] = fmt::format("images/{}.exr", v);
    }
    EXPECT_EQ(load().views[0].image.at(3, 3), Rgb(0.25f));
    CaptureFix fix;
    fix.fromBrackets = true;
    EXPECT_NE(load(fix).views[0].image.at(3, 3), Rgb(0.25f));
    std::filesystem::remove(folder / "images/1.exr");
    EXPECT_NE(load().views[0].image.at(3, 3), Rgb(0.25f));  // one view is missing, so all are merged: one scale
}

TEST_F(BracketCapture, WrongExposuresNameFrameAndEntry) {
    CaptureFix fix;
    fix.fromBrackets = true;
    file["frames"][0].erase("exposures");
    EXPECT_EQ(error(),
              "transforms.json: frame 0: exposures is missing, though other frames are merged from brackets: one scale "
              "for all needs them");
    file["frames"][1].erase("exposures");
    EXPECT_EQ(error(fix), "transforms.json: no frame has exposures, so there are no brackets to merge");
}

TEST_F(BracketCapture, AMissingTimeIsLookedForInTheFile) {
    file["frames"][1]["exposures"][2].erase("exposure_time");
    EXPECT_EQ(error(), "transforms.json: frame 1: exposures entry 2: " + (folder / "images/1-2.png").string() +
                           ": its exposure time is not given, and its EXIF has none");
}

TEST_F(BracketCapture, ExposuresOfAnotherSizeAreRefused) {
    writeImage(folder / "images/1-3.png", Image(64, 96, Rgb(0.5f)));
    const std::string message = error();
    EXPECT_NE(message.find((folder / "images/1-3.png").string() + ": is 64 x 96 pixels"), std::string::npos) << message;
}

TEST_F(BracketCapture, RadianceFilesAreNoBrackets) {
    writeImage(folder / "images/1-3.exr", Image(96, 64, Rgb(0.5f)));
    file["frames"][1]["exposures"][3]["file_path"] = "images/1-3.exr";
    EXPECT_NE(error().find("images/1-3.exr: is no 8 or 16 bit image, so it is radiance already"), std::string::npos);
}

}  // namespace
}  // namespace relamp
