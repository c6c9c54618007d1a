// Parts of a scan: codes, files, resection.
#include <gtest/gtest.h>

#include "scan/painted_scan.h"
#include "scan/scan_capture.h"

namespace relamp {
namespace {

using test::messageOf;

TEST(GrayCode, NeighboursDifferInOneBitAndTheInverseIsExact) {
    for (uint32_t n = 0; n < 1024; ++n) {
        EXPECT_EQ(numberOfGray(grayOf(n)), n);
        EXPECT_EQ(std::popcount(grayOf(n) ^ grayOf(n + 1)), 1);
    }
}

TEST(GrayCode, UnknownBitsGiveTheSmallestIntervalOfTheirCodes) {
    // Between 511 and 512 the coarsest of ten bits changes: it may be unknown there, and only there.
    const CodeInterval edge = intervalOf(grayOf(512), 512, 4);
    EXPECT_EQ(edge.low, 511);
    EXPECT_EQ(edge.high, 513);
    EXPECT_EQ(intervalOf(grayOf(700), 512, 4).width(), 0);
    // A missing bit leaves a block of four, or its middle.
    EXPECT_EQ(intervalOf(grayOf(8), 2, 4).width(), 4);
    EXPECT_EQ(intervalOf(grayOf(9), 2, 4).middle(), 10);
    EXPECT_EQ(intervalOf(grayOf(9), 0, 4).middle(), 9.5f);
}

TEST(Resection, FindsTheProjectorOfExactPointsAndSaysWhyItDoesNot) {
    const test::PaintedScan scene;
    std::vector<SeenPoint> points, flat;
    for (int i = 0; i < 400; ++i) {
        const Vec2 u = r2Point(uint32_t(i), Vec2(0.5f));
        const DVec3 point(double(u.x) * 0.4 - 0.2, double(u.y) * 0.2 - 0.1, i % 7 * 0.03);
        points.push_back({point, *scene.projector.projectByFormula(point)});
        flat.push_back({DVec3(point.x, point.y, 0), *scene.projector.projectByFormula(DVec3(point.x, point.y, 0))});
    }
    Progress progress;
    const Resection found = resect(points, 128, 64, progress);
    ASSERT_TRUE(found.camera) << found.reason;
    EXPECT_LT(glm::distance(found.camera->position(), scene.projector.position()), 1e-4);
    EXPECT_NEAR(found.camera->focalX, 190, 0.1);
    EXPECT_LT(found.median, 1e-3);
    EXPECT_NE(resect(flat, 128, 64, progress).reason.find("plane"), std::string::npos);
    for (SeenPoint& seen : points) seen.pixel.x = 128 - seen.pixel.x;
    EXPECT_NE(resect(points, 128, 64, progress).reason.find("mirrored"), std::string::npos);
    points.resize(10);
    EXPECT_NE(resect(points, 128, 64, progress).reason.find("too few"), std::string::npos);
}

TEST(ScanPhotographs, AreFoundByNumberAndWhatIsMissingIsSaid) {
    const test::TemporaryFolder folder;
    for (int i = 0; i < 10; ++i) {
        folder.write("a/IMG_" + std::to_string(100 + i) + ".png", "");
        if (i != 4 && i != 9) folder.write("b/IMG_" + std::to_string(100 + i) + ".png", "");
    }
    ScanBits bits{};
    const auto found = findScanPhotographs({folder / "a", folder / "b"}, bits);
    EXPECT_EQ(bits, (ScanBits{2, 2}));
    EXPECT_EQ(found[0].files[9].filename(), "IMG_109.png");
    EXPECT_TRUE(found[1].files[4].empty());
    EXPECT_EQ(found[1].files[5].filename(), "IMG_105.png");
    const auto refused = [&](const std::string& name, ScanBits given) {
        return messageOf([&] { findScanPhotographs({folder / name}, given); });
    };
    EXPECT_NE(refused("none", {}).find("none: cannot be read"), std::string::npos);
    EXPECT_NE(refused("a", {1, 1}).find("beyond the 6"), std::string::npos) << refused("a", {1, 1});
    folder.write("few/1.png", "");
    folder.write("few/2.png", "");
    folder.write("few/3.png", "");
    EXPECT_NE(refused("few", {}).find("few: 3 photographs"), std::string::npos) << refused("few", {});
    folder.write("dark/1.png", "");
    folder.write("dark/3.png", "");
    EXPECT_NE(refused("dark", {1, 1}).find("black photograph is missing"), std::string::npos);
    folder.write("empty/readme.txt", "");
    EXPECT_NE(refused("empty", {}).find("no photographs"), std::string::npos);
}

TEST(ScanCalibration, EveryFieldThatIsWrongIsNamed) {
    const test::TemporaryFolder folder;
    const std::string good = R"({"units":"millimetre","views":[{"name":"a","image":"a/0.jpg","width":8,"height":6,
"K":[[10,0,3.5],[0,10,2.5],[0,0,1]],"R":[[1,0,0],[0,1,0],[0,0,1]],"t":[0,0,500],
"distortion_k1k2p1p2k3":[0,0,0,0,0]}]})";
    const auto with = [&](const std::string& from, const std::string& to) {
        std::string text = good;
        text.replace(text.find(from), from.size(), to);
        return folder.write("cameras.json", text);
    };
    const Camera camera = readScanCalibration(with("8", "8")).cameras[0].camera;
    EXPECT_EQ(camera.position(), DVec3(0, 0, -0.5));
    EXPECT_EQ(camera.forward(), DVec3(0, 0, 1));
    EXPECT_EQ(*camera.project(DVec3(0, 0, 0)), Vec2(4, 3));
    const std::pair<const char*, std::pair<const char*, const char*>> wrong[] = {
        {"units", {"millimetre", "furlong"}},
        {"views[0].width", {"\"width\":8", "\"width\":0"}},
        {"views[0].K", {"[[10,0,3.5]", "[[10,2,3.5]"}},
        {"K[0][0]", {"[[10,0", "[[0,0"}},
        {"views[0].R", {"[[1,0,0]", "[[2,0,0]"}},
        {"views[0].t", {"[0,0,500]", "[0,0]"}},
        {"views[0].name", {"\"a\"", "\"../a\""}},
        {"views", {"views", "vews"}},
        {"distortion_k1k2p1p2k3", {"[0,0,0,0,0]", "[0,0,0,0,\"k\"]"}}};
    for (const auto& [field, change] : wrong) {
        const auto file = with(change.first, change.second);
        const std::string message = messageOf([&] { readScanCalibration(file); });
        EXPECT_NE(message.find("cameras.json"), std::string::npos) << message;
        EXPECT_NE(message.find(field), std::string::npos) << message;
    }
}

}  // namespace
}  // namespace relamp
