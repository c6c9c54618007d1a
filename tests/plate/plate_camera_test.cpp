#include "plate/plate_camera.h"

#include <gtest/gtest.h>

#include "plate/usd_text.h"
#include "shot/export_scene.h"
#include "shot/frame_numbers.h"

namespace relamp {
namespace {

using test::TemporaryFolder;

/// A rotation by degrees about one axis, written out.
glm::dmat3 about(int axis, double degrees) {
    const double c = std::cos(glm::radians(degrees)), s = std::sin(glm::radians(degrees));
    if (axis == 0) return {DVec3(1, 0, 0), DVec3(0, c, s), DVec3(0, -s, c)};
    if (axis == 1) return {DVec3(c, 0, -s), DVec3(0, 1, 0), DVec3(s, 0, c)};
    return {DVec3(c, s, 0), DVec3(-s, c, 0), DVec3(0, 0, 1)};
}

void expectSame(const DMat4& a, const DMat4& b, double tolerance = 1e-9) {
    for (int c = 0; c < 4; ++c)
        for (int r = 0; r < 4; ++r) EXPECT_NEAR(a[c][r], b[c][r], tolerance) << c << " " << r;
}

Capture worldOf(const Vec3& up) {
    Capture capture;
    capture.worldFromFile = rotationToZUp(up);
    capture.views.resize(1);
    return capture;
}

std::string errorOf(const std::function<void()>& body) {
    try {
        body();
    } catch (const Error& error) { return error.what(); }
    return "";
}

TEST(ChanCamera, TurnsAboutTheFirstNamedAxisFirst) {
    const TemporaryFolder folder;
    const auto file = folder.write("c.chan", "# a comment\n1001 1 2 3 10 20 30 40\r\n1002\t4 5 6 0 0 0 40 9\n\n");
    const CameraTrack zxy = readChan(file, "ZXY"), xyz = readChan(file, "XYZ");
    ASSERT_EQ(zxy.byFrame.size(), 2u);
    DMat4 expected(about(1, 20) * about(0, 10) * about(2, 30));
    expected[3] = glm::dvec4(1, 2, 3, 1);
    expectSame(zxy.byFrame.at(1001).worldFromCamera, expected);
    expected = DMat4(about(2, 30) * about(1, 20) * about(0, 10));
    expected[3] = glm::dvec4(1, 2, 3, 1);
    expectSame(xyz.byFrame.at(1001).worldFromCamera, expected);
    EXPECT_NEAR(zxy.byFrame.at(1001).halfHeight, std::tan(glm::radians(20.0)), 1e-12);
}

TEST(ChanCamera, ErrorsNameTheLine) {
    const TemporaryFolder folder;
    const auto error = [&](const char* text) {
        return errorOf([&] { readChan(folder.write("c.chan", text), "ZXY"); });
    };
    EXPECT_NE(error("1 2 3 4 5 6 7 40\n2 x 3 4 5 6 7 40\n").find("line 2: 'x'"), std::string::npos);
    EXPECT_NE(error("1 2 3 4\n").find("line 1: has 4 numbers"), std::string::npos);
    EXPECT_NE(error("1 0 0 0 0 0 0 180\n").find("field of view"), std::string::npos);
    EXPECT_NE(error("1 0 0 0 0 0 0 40\n1 0 0 0 0 0 0 40\n").find("twice"), std::string::npos);
    EXPECT_NE(error("1.5 0 0 0 0 0 0 40\n").find("no frame number"), std::string::npos);
    EXPECT_NE(error("1 nan 0 0 0 0 0 40\n").find("line 1"), std::string::npos);
    EXPECT_NE(error("").find("holds no frame"), std::string::npos);
    EXPECT_THROW(readChan(folder.write("c.chan", "1 0 0 0 0 0 0 40\n"), "XXZ"), BadOption);
}

TEST(UsdCamera, ReadsBackWhatTheExportWrites) {
    const TemporaryFolder folder;
    ExportedScene scene;
    Camera camera = test::cameraAt({1, -2, 1.5}, {0, 0.2, 0.3}, 640, 480, 700);
    camera.focalY = 705;
    camera.centreX = 330;
    camera.centreY = 236;
    scene.views.push_back({"one", camera});
    scene.views.push_back({"two", test::cameraAt({2, 1, 1}, {0, 0, 0}, 640, 480, 500)});
    const auto file = folder.write("s.usda", usdaOf(scene, "environment.exr"));
    std::string names;
    for (const UsdPrim& prim : readUsdText(file).prims)
        if (prim.type == "Camera" && names.empty()) names = prim.name;
    Capture capture = worldOf({0, 0, 1});
    Progress progress;
    const PlateFiles files{{7, "p.0007.exr"}, {8, "p.0008.exr"}};
    const PlateCameras read = readPlateCameras(capture, file.string() + "#" + names, files, 640, 480, {}, progress);
    ASSERT_EQ(read.byFrame.size(), 2u);
    const Camera& got = read.byFrame.at(8);
    expectSame(got.worldFromCamera, camera.worldFromCamera, 1e-6);
    EXPECT_NEAR(got.focalX, camera.focalX, 1e-3);
    EXPECT_NEAR(got.focalY, camera.focalY, 1e-3);
    EXPECT_NEAR(got.centreX, camera.centreX, 1e-3);
    EXPECT_NEAR(got.centreY, camera.centreY, 1e-3);
    // Without a name nobody can know which.
    EXPECT_NE(errorOf([&] { readPlateCameras(capture, file, files, 640, 480, {}, progress); }).find("several cameras"),
              std::string::npos);
}

constexpr const char* movingCamera = R"(#usda 1.0
( """Made (by) "hand" } """
    doc = "a { bracket"
    metersPerUnit = 0.01
    upAxis = "Y"
)
def Xform "rig" (
    kind = "component"
)
{
    double3 xformOp:translate = (100, 0, 0)
    uniform token[] xformOpOrder = ["xformOp:translate"]
    variantSet "look" = {
        "a" { def Camera "hidden" { } }
    }
    token outputs:nothing
    def Camera "cam" # the one
    {
        float2 clippingRange = (0.1, 1000)
        float focalLength.timeSamples = { 1001: 20, 1005: 40, }
        float horizontalAperture = 20
        float verticalAperture = 15
        float3 xformOp:rotateXYZ = (0, 90, 0)
        double3 xformOp:translate.timeSamples = {
            1001: (0, 50, 0), # start
            1005: (0, 50, 400),
        }
        uniform token[] xformOpOrder = ["xformOp:translate", "xformOp:rotateXYZ"]
    }
    def Mesh "big" { int[] faceVertexIndices = [0, 1, 2] point3f[] points = [(1,2,3)] }
}
)";

TEST(UsdCamera, FollowsParentsSamplesAndUnits) {
    const TemporaryFolder folder;
    const auto file = folder.write("m.usda", movingCamera);
    const CameraTrack track = readUsdCamera(file, "");
    ASSERT_EQ(track.byFrame.size(), 5u);
    EXPECT_EQ(track.up, "y");
    DMat4 expected(about(1, 90));
    expected[3] = glm::dvec4(100, 50, 200, 1);
    expectSame(track.byFrame.at(1003).worldFromCamera, expected);
    EXPECT_NEAR(track.byFrame.at(1003).halfWidth, 20.0 / 60, 1e-12);

    // In the capture's world: Y up becomes Z up, centimetres metres, whatever the capture's own files have.
    Progress progress;
    const PlateCameras cameras =
        readPlateCameras(worldOf({0, 0, 1}), file, {{1003, "p.1003.exr"}}, 400, 300, {}, progress);
    const Camera& camera = cameras.byFrame.at(1003);
    EXPECT_NEAR(glm::distance(camera.position(), DVec3(1, -2, 0.5)), 0, 1e-9);
    EXPECT_NEAR(glm::distance(camera.forward(), DVec3(-1, 0, 0)), 0, 1e-9);
    EXPECT_NEAR(camera.focalX, 600, 1e-9);
    EXPECT_NEAR(camera.focalY, 600, 1e-9);
}

TEST(UsdCamera, UndoesInvertedSteps) {
    const TemporaryFolder folder;
    const auto file = folder.write("p.usda", R"(#usda 1.0
def Camera "c" {
    double3 xformOp:translate:pivot = (1, 2, 3)
    double xformOp:rotateZ = 90
    quatf xformOp:orient = (0.7071067811865476, 0.7071067811865476, 0, 0)
    uniform token[] xformOpOrder = ["xformOp:translate:pivot", "xformOp:rotateZ", "!invert!xformOp:translate:pivot",
        "xformOp:orient"]
})");
    const CameraTrack track = readUsdCamera(file, "/c");
    EXPECT_TRUE(track.still);
    DMat4 expected(about(2, 90) * about(0, 90));
    const DVec3 pivot(1, 2, 3);
    expected[3] = glm::dvec4(pivot - about(2, 90) * pivot, 1);
    expectSame(track.byFrame.at(0).worldFromCamera, expected, 1e-7);
}

TEST(UsdCamera, BadFilesAreNamed) {
    const TemporaryFolder folder;
    const auto error = [&](const std::string& text) {
        return errorOf([&] { readUsdCamera(folder.write("b.usda", text), ""); });
    };
    EXPECT_NE(error("PXR-USDC").find("usdcat"), std::string::npos);
    EXPECT_NE(error("#usda 1.0\n").find("holds no camera"), std::string::npos);
    EXPECT_NE(error("#usda 1.0\ndef Camera \"c\" {\n").find("does not end"), std::string::npos);
    EXPECT_EQ(error("#usda 1.0\ndef Camera \"c\" {; float focalLength = 20;; }\n"), "");
    EXPECT_NE(error("#usda 1.0\ndef Camera \"c").find("line 2: a text has no end"), std::string::npos);
    EXPECT_NE(error("#usda 1.0\ndef Camera \"c\" { double3 xformOp:translate = (1, 2)\n uniform token[] xformOpOrder = "
                    "[\"xformOp:translate\"] }")
                  .find("2 numbers, expected 3"),
              std::string::npos);
    EXPECT_NE(error("#usda 1.0\ndef Camera \"c\" { float focalLength = 0\n }").find("focalLength 0"),
              std::string::npos);
    std::string deep = "#usda 1.0\n";
    for (int i = 0; i < 1000; ++i) deep += "def Xform \"x\" {\n";
    EXPECT_NE(error(deep).find("deep"), std::string::npos);
    EXPECT_NE(error("#usda 1.0\ndef Camera \"c\" { double3 xformOp:translate.timeSamples = { 0: (0,0,0), 1e8: (0,0,0) "
                    "}\n uniform token[] xformOpOrder = [\"xformOp:translate\"] }")
                  .find("frames"),
              std::string::npos);
}

std::string transformsOfFrames(const std::string& first, const std::string& second) {
    const auto frame = [](const std::string& path, int x) {
        return "{" + (path.empty() ? "" : "\"file_path\": \"" + path + "\", ") + "\"transform_matrix\": [[1,0,0," +
               std::to_string(x) + "],[0,1,0,0],[0,0,1,0],[0,0,0,1]]}";
    };
    return "{\"w\": 64, \"h\": 48, \"fl_x\": 80, \"k1\": 0.1, \"frames\": [" + frame(first, 1) + "," +
           frame(second, 2) + "]}";
}

TEST(PlateCameras, OfTransformsGoByTheirNamesElseByTheOrder) {
    const TemporaryFolder folder;
    Progress progress;
    const Capture capture = worldOf({0, 0, 1});
    const PlateFiles files{{101, "a"}, {105, "b"}};
    const auto read = [&](const std::string& text, int width, const PlateCameraOptions& options = {}) {
        return readPlateCameras(capture, folder.write("t.json", text), files, width, width * 3 / 4, options, progress);
    };
    const PlateCameras named = read(transformsOfFrames("x/p.0105.exr", "x/p.0101.exr"), 128);
    EXPECT_EQ(named.byFrame.at(105).position().x, 1);
    EXPECT_EQ(named.byFrame.at(101).position().x, 2);
    EXPECT_EQ(named.byFrame.at(101).focalX, 160);  // the plate is twice as large
    EXPECT_EQ(named.byFrame.at(101).distortion[0], 0.1);
    const PlateCameras ordered = read(transformsOfFrames("", ""), 64);
    EXPECT_EQ(ordered.byFrame.at(101).position().x, 1);
    EXPECT_EQ(ordered.byFrame.at(105).position().x, 2);
    const PlateCameras moved = read(transformsOfFrames("p.1.exr", "p.5.exr"), 64, {{}, "ZXY", 100});
    EXPECT_EQ(moved.byFrame.count(101), 1u);
    EXPECT_EQ(moved.byFrame.count(105), 1u);
    EXPECT_NE(errorOf([&] {
                  readPlateCameras(capture, folder / "t.json", files, 64, 64, {}, progress);
              }).find("another shape"),
              std::string::npos);
}

TEST(PlateCameras, TakeTheirLensFromAFile) {
    const TemporaryFolder folder;
    Progress progress;
    const auto chan = folder.write("c.chan", "3 0 0 5 0 0 0\n");
    const PlateFiles files{{3, "a"}};
    const Capture capture = worldOf({0, 1, 0});
    EXPECT_NE(errorOf([&] { readPlateCameras(capture, chan, files, 640, 480, {}, progress); }).find("--plate-lens"),
              std::string::npos);
    PlateCameraOptions options;
    options.lens =
        folder.write("lens.json", R"({"camera_model": "OPENCV", "w": 1280, "h": 960, "fl_x": 1000, "fl_y": 1010,
        "cx": 650, "cy": 470, "k1": -0.05, "p2": 0.001})");
    const Camera camera = readPlateCameras(capture, chan, files, 640, 480, options, progress).byFrame.at(3);
    EXPECT_EQ(camera.focalX, 500);
    EXPECT_EQ(camera.centreY, 235);
    EXPECT_EQ(camera.distortion[0], -0.05);
    // The file's Y is up: five units along its Z lie at -5 along the world's Y.
    EXPECT_NEAR(glm::distance(camera.position(), DVec3(0, -5, 0)), 0, 1e-6);
}

}  // namespace
}  // namespace relamp
