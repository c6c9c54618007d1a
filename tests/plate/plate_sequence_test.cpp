#include "plate/plate_sequence.h"

#include <gtest/gtest.h>

#include "shot/frame_numbers.h"

namespace relamp {
namespace {

using test::TemporaryFolder;

TEST(PlateFiles, AreFoundByTheirNumberWhicheverWayItIsPadded) {
    const TemporaryFolder folder;
    for (const char* name : {"p.0999.exr", "p.1001.exr", "p.10002.exr", "p.1003.png", "p.12.exr", "q.1004.exr"})
        folder.write(name, "");
    const PlateFiles files = plateFiles(folder / "p.####.exr", "--plate");
    ASSERT_EQ(files.size(), 3u);
    EXPECT_EQ(files.begin()->first, 999);
    EXPECT_EQ(files.rbegin()->first, 10002);
    EXPECT_EQ(plateFiles(folder / "p.%04d.exr", "--plate"), files);
    EXPECT_EQ(plateFiles(folder / "p.%d.exr", "--plate").count(12), 1u);
}

TEST(PlateFiles, OneImageBearsTheNumberInItsName) {
    const TemporaryFolder folder;
    EXPECT_EQ(plateFiles(folder.write("shot2_1042.exr", ""), "--plate").begin()->first, 1042);
    EXPECT_EQ(plateFiles(folder.write("still.exr", ""), "--plate").begin()->first, 1);
}

TEST(PlateFiles, OneFrameNamesTheOthers) {
    EXPECT_EQ(platePattern("/a/plate.1001.exr"), "/a/plate.####.exr");
    EXPECT_EQ(platePattern("shot2_v03.007.png"), "shot2_v03.###.png");
    EXPECT_EQ(platePattern("12.jpg"), "##.jpg");
    EXPECT_EQ(platePattern("still.exr"), "still.exr");
    EXPECT_EQ(platePattern("plate.####.exr"), "plate.####.exr");
}

TEST(PlateFiles, WhatIsNotThereIsNamedWithItsOption) {
    const TemporaryFolder folder;
    const auto message = [&](const std::string& pattern) {
        try {
            plateFiles(folder / pattern, "--matte");
        } catch (const Error& error) { return std::string(error.what()); }
        return std::string();
    };
    EXPECT_NE(message("m.####.exr").find("--matte"), std::string::npos);
    EXPECT_NE(message("m.####.exr").find("holds no such frame"), std::string::npos);
    EXPECT_NE(message("m.exr").find("does not exist"), std::string::npos);
    EXPECT_THROW(plateFiles(folder / "a##.##.exr", "--plate"), BadOption);
}

TEST(PlateCurves, AreTheirStandards) {
    EXPECT_NEAR(decoded(PlateCurve::srgb, 0.5f), 0.2140411f, 1e-6);
    EXPECT_NEAR(decoded(PlateCurve::rec709, 0.5f), 0.2595894f, 1e-6);
    EXPECT_NEAR(decoded(PlateCurve::rec709, 0.04f), 0.04f / 4.5f, 1e-7);
    EXPECT_NEAR(decoded(PlateCurve::gamma22, 0.5f), 0.2176376f, 1e-6);
    EXPECT_NEAR(decoded(PlateCurve::gamma24, 0.5f), 0.1894646f, 1e-6);
    EXPECT_EQ(decoded(PlateCurve::linear, 7.5f), 7.5f);
    EXPECT_EQ(decoded(PlateCurve::srgb, -0.01f), -0.01f);
    EXPECT_THROW(plateCurve("logc"), BadOption);
}

TEST(ReadPlate, KeepsNegativeValuesAndTakesAStatedCurve) {
    const TemporaryFolder folder;
    writeChannels(folder / "p.exr", 2, 1, {{"R", false, {-0.25f, 0.5f}}, {"G", false, {1, 2}}, {"B", false, {3, 4}}});
    float saturation = 1;
    const Image linear = readPlate(folder / "p.exr", PlateCurve::automatic, saturation);
    EXPECT_EQ(linear.pixels[0], Rgb(-0.25f, 1, 3));
    EXPECT_TRUE(linear.usable.empty());
    EXPECT_EQ(saturation, 0);
    EXPECT_NEAR(readPlate(folder / "p.exr", PlateCurve::gamma22, saturation).pixels[1].x, 0.2176376f, 1e-6);

    Image grey(1, 1, Rgb(0.2140411f));
    writeImage(folder / "p.png", grey);
    EXPECT_NEAR(readPlate(folder / "p.png", PlateCurve::automatic, saturation).pixels[0].x, 0.214f, 2e-3);
    EXPECT_GT(saturation, 0.9f);
    EXPECT_NEAR(readPlate(folder / "p.png", PlateCurve::linear, saturation).pixels[0].x, 0.5f, 2e-3);
}

TEST(ReadMatte, IsRefusedInAnotherSize) {
    const TemporaryFolder folder;
    Image white(3, 2, Rgb(1));
    writeImage(folder / "m.png", white);
    EXPECT_EQ(readMatte(folder / "m.png", 3, 2), std::vector<float>(6, 1));
    EXPECT_THROW(readMatte(folder / "m.png", 2, 3), Error);
}

}  // namespace
}  // namespace relamp
