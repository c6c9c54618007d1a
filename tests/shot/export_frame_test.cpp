#include "shot/export_frame.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <regex>

#include "image/image_io.h"
#include "support/estimates.h"
#include "support/exr_header.h"
#include "support/temporary_folder.h"

namespace relamp {
namespace {

using Numbers = std::vector<int>;

TEST(FrameRange, ReadsNumbersSpansAndSteps) {
    EXPECT_EQ(parseFrameRange("4"), (Numbers{4}));
    EXPECT_EQ(parseFrameRange("1-3,5,7-12:2"), (Numbers{1, 2, 3, 5, 7, 9, 11}));
    EXPECT_EQ(parseFrameRange("0-0"), (Numbers{0}));
    EXPECT_EQ(parseFrameRange("3-10:100"), (Numbers{3}));
}

TEST(FrameRange, RefusesWhatItCannotMean) {
    for (const char* text : {"", ",", "1,", "a", "1-", "-3", "1--3", "3-1", "1-9:0", "1-9:", "1-9:x", "1.5", "1 2",
                             "999999999", "1-99999999", "0-999999,5"})
        EXPECT_EQ(test::messageOf([&] { parseFrameRange(text); }).substr(0, 8), "--frames") << text;
}

/// Three views of 40 x 30 pixels.
Capture threeViews() {
    Capture capture;
    for (int i = 0; i < 3; ++i) {
        View view;
        view.name = fmt::format("{}.exr", i);
        view.camera = test::cameraAt({double(i), -3, 1}, {0, 0, 0}, 40, 30, 50);
        capture.views.push_back(view);
    }
    return capture;
}

TEST(FrameJobs, OfAllViewsAreNumberedFromOne) {
    const auto jobs = frameJobs(threeViews(), "all", "", "", "out/frame.####.exr");
    ASSERT_EQ(jobs.size(), 3u);
    EXPECT_EQ(jobs[0].file, "out/frame.0001.exr");
    EXPECT_EQ(jobs[2].file, "out/frame.0003.exr");
    EXPECT_EQ(jobs[2].number, 3);
    EXPECT_EQ(jobs[2].camera.position(), DVec3(2, -3, 1));
    EXPECT_EQ(frameJobs(threeViews(), "all", "2", "", "f%03d.exr")[0].file, "f002.exr");
    EXPECT_EQ(frameJobs(threeViews(), "all", "2", "", "f%d.exr")[0].file, "f2.exr");
}

TEST(FrameJobs, PutTheNumberIntoTheFileNameNotIntoItsFolder) {
    EXPECT_EQ(frameJobs(threeViews(), "all", "1-2", "", "shot#7/frame.##.exr")[1].file, "shot#7/frame.02.exr");
    EXPECT_NE(test::messageOf([] { frameJobs(threeViews(), "all", "1-2", "", "shot####/frame.exr"); }), "");
}

TEST(FrameJobs, OutsideTheShotAreSkippedAndARangeNeedsAPlaceForTheNumber) {
    EXPECT_EQ(frameJobs(threeViews(), "all", "2-9", "", "f.##.exr").size(), 2u);
    EXPECT_EQ(test::messageOf([] { frameJobs(threeViews(), "all", "7", "", "f.##.exr"); }),
              "--frames 7: holds none of the frames 1 to 3");
    EXPECT_EQ(test::messageOf([] { frameJobs(threeViews(), "all", "1-2", "", "frame.exr"); }),
              "frame.exr: several frames need a name with #### or %04d");
    EXPECT_EQ(frameJobs(threeViews(), "all", "2", "", "frame.exr")[0].file, "frame.exr");
    EXPECT_NE(test::messageOf([] { frameJobs(threeViews(), "all", "1", "", "f%99999999999999999999d.exr"); }), "");
}

TEST(FrameJobs, OneCameraTakesARangeForALookThatMoves) {
    const auto jobs = frameJobs(threeViews(), "1", "5-9:4", "", "f.##.exr");
    ASSERT_EQ(jobs.size(), 2u);
    EXPECT_EQ(jobs[1].file, "f.09.exr");
    EXPECT_EQ(jobs[1].number, 9);
    EXPECT_EQ(jobs[1].view, 1);
    EXPECT_EQ(jobs[0].camera.worldFromCamera, jobs[1].camera.worldFromCamera);
    EXPECT_NE(test::messageOf([] { frameJobs(threeViews(), "1", "5-9:4", "", "f.exr"); }), "");
}

TEST(FrameJobs, OfOneViewCountFromZero) {
    const auto jobs = frameJobs(threeViews(), "1", "", "", "frame.exr");
    ASSERT_EQ(jobs.size(), 1u);
    EXPECT_EQ(jobs[0].file, "frame.exr");
    EXPECT_EQ(jobs[0].camera.position(), DVec3(1, -3, 1));
    EXPECT_EQ(test::messageOf([] { frameJobs(threeViews(), "3", "", "", "frame.exr"); }).substr(0, 10), "--camera 3");
}

TEST(FrameJobs, SizeScalesTheCamera) {
    const Camera camera = frameJobs(threeViews(), "0", "", "80x90", "frame.exr")[0].camera;
    EXPECT_EQ(camera.width, 80);
    EXPECT_EQ(camera.height, 90);
    EXPECT_DOUBLE_EQ(camera.focalX, 100);
    EXPECT_DOUBLE_EQ(camera.focalY, 150);
    EXPECT_DOUBLE_EQ(camera.centreX, 40);
    EXPECT_DOUBLE_EQ(camera.centreY, 45);
    for (const char* size : {"80", "x", "80x", "0x5", "80x-1", "a x b", "99999999x99999999"})
        EXPECT_EQ(test::messageOf([&] { frameJobs(threeViews(), "0", "", size, "frame.exr"); }).substr(0, 6), "--size")
            << size;
}

TEST(FrameJobs, TakeACameraFromAFile) {
    const test::TemporaryFolder folder;
    const auto file = folder.write(
        "camera.json",
        R"({"w": 64, "h": 48, "fl_x": 70, "transform_matrix": [[1,0,0,0],[0,1,0,0],[0,0,1,9],[0,0,0,1]]})");
    const Camera camera = frameJobs(threeViews(), file.string(), "", "", "frame.exr")[0].camera;
    EXPECT_EQ(camera.width, 64);
    EXPECT_EQ(camera.position(), DVec3(0, 0, 9));
    EXPECT_NE(test::messageOf([&] {
                  frameJobs(threeViews(), (folder / "absent.json").string(), "", "", "frame.exr");
              }).find("absent.json"),
              std::string::npos);
    folder.write("camera.json",
                 R"({"w": 64, "h": 48, "fl_x": 0, "transform_matrix": [[1,0,0,0],[0,1,0,0],[0,0,1,9],[0,0,0,1]]})");
    EXPECT_NE(test::messageOf([&] {
                  frameJobs(threeViews(), file.string(), "", "", "frame.exr");
              }).find("camera.json: fl_x is 0"),
              std::string::npos);
}

/// A small frame with a world group and two emitters, one of them with a name no channel may have.
class WrittenFrame : public testing::Test {
protected:
    void SetUp() override {
        Mesh mesh = test::sheet({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, 2, 2);
        const Scene scene = test::sceneOf(mesh);
        Look look;
        look.added.push_back({EmitterShape::disk, "disk-1", test::translation({0, 0, 1}), Vec2(0.5f), Rgb(10)});
        look.added.back().name = "Key light";
        look.added.push_back(
            {EmitterShape::disk, "7 of.9", test::translation({0.5f, 0, 1}), Vec2(0.5f), Rgb(200000, 1, 1)});
        relit = test::relitOf(scene, test::matteEstimate(scene, Rgb(0.5f), Rgb(1)), look);
        camera = test::cameraAt({0, -2, 1.5}, {0, 0, 0}, 24, 16, 20);
        FrameOptions options;
        options.samplesPerPixel = 2;
        Progress progress;
        frame = renderFrame(relit, camera, options, progress);
    }
    test::ExrHeader write(const std::string& layers) {
        EXPECT_LT(writeFrame(folder / "frame.exr", frame, relit, camera, layers), 1e-5);
        return test::readExrHeader(folder / "frame.exr");
    }
    test::TemporaryFolder folder;
    RelitScene relit;
    Camera camera;
    Frame frame;
};

TEST_F(WrittenFrame, HasRootColourAndAlphaOnlyUnlessLayersAreAskedFor) {
    const test::ExrHeader header = write("");
    EXPECT_EQ(header.channelNames(), (std::set<std::string>{"R", "G", "B", "A"}));
    EXPECT_FALSE(header.multipart);
    EXPECT_EQ(header.compression, "zip");
}

TEST_F(WrittenFrame, OfARegionLiesInItsPlaceInTheWholeImage) {
    const ImageBox box = boxOf({{0.25f, 0.25f}, {0.66f, 0.68f}}, camera.width, camera.height);
    EXPECT_EQ(box, (ImageBox{6, 4, 10, 7}));
    FrameOptions options;
    options.samplesPerPixel = 1;
    Progress progress;
    const Frame part = renderFrame(relit, cropped(camera, box), options, progress);
    EXPECT_LT(writeFrame(folder / "part.exr", part, relit, camera, "groups,depth", {}, box), 1e-5);
    writeFrame(folder / "part.png", part, relit, camera, "", {}, box);
    const Image whole = readImage(folder / "part.exr");
    ASSERT_EQ(std::pair(whole.width, whole.height), std::pair(24, 16));
    ASSERT_EQ(whole.usable.size(), whole.pixels.size());
    for (int y = 0; y < whole.height; ++y)
        for (int x = 0; x < whole.width; ++x) {
            const size_t p = size_t(y * whole.width + x);
            const bool inside = x >= box.left && x < box.left + box.width && y >= box.top && y < box.top + box.height;
            const size_t q = inside ? size_t((y - box.top) * box.width + x - box.left) : 0;
            EXPECT_EQ(whole.usable[p] != 0, inside && part.alpha[q] >= 0.5f) << x << " " << y;
            if (!inside) continue;
            EXPECT_NEAR(whole.pixels[p].y, part.beauty[q].y, 1e-3f * part.beauty[q].y + 1e-4f);
            EXPECT_NEAR(part.depth[q], frame.depth[p], 1e-4f * frame.depth[p]) << "the part shows what the whole shows";
        }
    EXPECT_EQ(readImageSize(folder / "part.png"), std::pair(10, 7));
    // A region of no extent is the pixel it lies in.
    EXPECT_EQ(boxOf({{1, 1}, {1, 1}}, 24, 16), (ImageBox{23, 15, 1, 1}));
    EXPECT_EQ(boxOf({}, 24, 16), (ImageBox{0, 0, 24, 16}));
}

TEST_F(WrittenFrame, HasEveryLayerWithNamesThatOtherProgramsRead) {
    const test::ExrHeader header = write("all");
    const std::regex form("([A-Za-z][A-Za-z0-9_]*\\.)?[A-Za-z]");
    for (const auto& [name, type] : header.channels) {
        EXPECT_TRUE(std::regex_match(name, form)) << name;
        const bool geometry = name.starts_with("normal") || name.starts_with("position") || name.starts_with("depth") ||
                              name.starts_with("Crypto");
        EXPECT_EQ(type, geometry ? "float" : "half") << name;
    }
    for (const char* name : {"R", "G", "B", "A", "Combined_world.R", "Combined_Key_light.G", "Combined_L_7_of_9.B",
                             "Combined_rest.G", "correction.B", "CryptoEmitter00.R", "CryptoEmitter02.A", "albedo.R",
                             "normal.X", "normal.Z", "position.Y", "depth.Z"})
        EXPECT_TRUE(header.channels.contains(name)) << name;
    EXPECT_EQ(header.channels.size(), 4u + 4 * 3 + 3 + 3 + 3 + 3 + 1 + 1 + 3 * 4);
}

TEST_F(WrittenFrame, HoldsOnlyTheLayersNamed) {
    EXPECT_EQ(write("depth,albedo").channelNames(),
              (std::set<std::string>{"R", "G", "B", "A", "albedo.R", "albedo.G", "albedo.B", "depth.Z"}));
    EXPECT_NE(test::messageOf([] { checkLayers("depth,beauty"); }).find("beauty"), std::string::npos);
    checkLayers("all");
    checkLayers("");
}

TEST_F(WrittenFrame, KeepsItsColoursAndNeverWritesInfinity) {
    frame.beauty[5] = Rgb(1e9f, 2, 3);
    writeFrame(folder / "frame.exr", frame, relit, camera, "");
    ImageReport report;
    const Image image = readImage(folder / "frame.exr", &report);
    EXPECT_EQ(report.infinite + report.nan + report.negative, 0u);
    EXPECT_EQ(image.pixels[5].x, 65504);
    for (size_t p = 6; p < image.pixels.size(); ++p)
        for (int c = 0; c < 3; ++c)
            ASSERT_NEAR(image.pixels[p][c], frame.beauty[p][c], 1e-3 * frame.beauty[p][c] + 1e-6);
}

TEST_F(WrittenFrame, ReportsGroupsThatDoNotAddUp) {
    frame.world[7] += Rgb(100);
    EXPECT_GT(writeFrame(folder / "frame.exr", frame, relit, camera, ""), 1e-4);
}

TEST_F(WrittenFrame, AsPngIsTheBeautyInSrgb) {
    frame.beauty.assign(frame.beauty.size(), Rgb(0.5f));
    writeFrame(folder / "frame.png", frame, relit, camera, "");
    EXPECT_NEAR(readImage(folder / "frame.png", nullptr, true).at(3, 3).x, srgbEncode(0.5f), 0.005);
}

TEST_F(WrittenFrame, IsWrittenWholeOrNotAtAll) {
    EXPECT_NE(
        test::messageOf([&] { writeFrame(folder / "absent/frame.exr", frame, relit, camera, ""); }).find("absent"),
        std::string::npos);
    folder.write("frame.exr", "what was there");
    EXPECT_NE(test::messageOf([&] { writeFrame(folder / "frame.exr", frame, relit, camera, "nonsense"); }), "");
    EXPECT_EQ(test::TemporaryFolder::read(folder / "frame.exr"), "what was there");
    EXPECT_EQ(folder.entries(), 1u);
}

}  // namespace
}  // namespace relamp
