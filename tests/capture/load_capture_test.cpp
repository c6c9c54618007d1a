#include "capture/load_capture.h"

#include <gtest/gtest.h>

#include <limits>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "capture/capture_formats.h"
#include "capture/check.h"
#include "capture/photograph_reader.h"
#include "support/known_world.h"
#include "support/temporary_folder.h"

namespace relamp {
namespace {

using nlohmann::json;

/// Two views of 16 x 12 pixels straight down on a square of two metres.
class LoadCapture : public testing::Test {
protected:
    void SetUp() override {
        folder.write("mesh.obj", "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nf 1 2 3 4\n");
        std::filesystem::create_directories(folder / "images");
        for (const char* name : {"images/a.exr", "images/b.exr"}) writeImage(folder / name, Image(16, 12, Rgb(0.5f)));
        file = {{"w", 16}, {"h", 12}, {"fl_x", 12}, {"frames", json::array()}};
        for (const char* name : {"images/a.exr", "images/b.exr"})
            file["frames"].push_back(
                {{"file_path", name}, {"transform_matrix", {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 2}, {0, 0, 0, 1}}}});
    }
    Capture load(const LoadOptions& options = {}) {
        folder.write("transforms.json", file.dump());
        Progress progress;
        return loadCapture(folder.path(), options, progress);
    }
    std::string error() {
        return test::messageOf([&] { load(); });
    }
    static bool anyHolds(const std::vector<std::string>& sentences, const std::string& text) {
        return std::any_of(sentences.begin(), sentences.end(),
                           [&](const std::string& s) { return s.find(text) != std::string::npos; });
    }

    test::TemporaryFolder folder;
    json file;
};

TEST_F(LoadCapture, ReadsViewsMeshAndImages) {
    const Capture capture = load();
    ASSERT_EQ(capture.views.size(), 2u);
    EXPECT_EQ(capture.views[1].name, "images/b.exr");
    EXPECT_EQ(capture.views[1].image.at(3, 3), Rgb(0.5f));
    EXPECT_EQ(capture.views[1].saturation, 0);
    EXPECT_EQ(capture.mesh.triangles.size(), 2u);
    EXPECT_TRUE(capture.notes.empty());
    EXPECT_TRUE(load({.images = false}).views[0].image.pixels.empty());
}

/// glTF has Y up; the buffer beside it is one of the capture's files.
TEST_F(LoadCapture, TurnsAGltfMeshToTheCamerasUp) {
    std::filesystem::remove(folder / "mesh.obj");
    std::string buffer;
    for (const float x :
         {-1.f, 0.f, 1.f, 1.f, 0.f, 1.f, 1.f, 0.f, -1.f, -1.f, 0.f, 1.f, 1.f, 0.f, -1.f, -1.f, 0.f, -1.f})
        buffer.append(reinterpret_cast<const char*>(&x), 4);
    folder.write("mesh.bin", buffer);
    const json gltf{{"asset", {{"version", "2.0"}}},
                    {"buffers", {{{"byteLength", 72}, {"uri", "mesh.bin"}}}},
                    {"bufferViews", {{{"buffer", 0}, {"byteLength", 72}}}},
                    {"accessors", {{{"bufferView", 0}, {"componentType", 5126}, {"count", 6}, {"type", "VEC3"}}}},
                    {"meshes", {{{"primitives", {{{"attributes", {{"POSITION", 0}}}}}}}}},
                    {"nodes", {{{"mesh", 0}}}}};
    folder.write("mesh.gltf", gltf.dump());
    const Capture capture = load();
    EXPECT_EQ(capture.mesh.positions[2], Vec3(1, 1, 0));
    EXPECT_LT(glm::distance(capture.mesh.normals[0], Vec3(0, 0, 1)), 1e-6f);
    EXPECT_TRUE(anyHolds(capture.notes, "--mesh-up z"));
    LoadOptions asItIs;
    asItIs.fix.meshUp = "z";
    EXPECT_EQ(load(asItIs).mesh.positions[2], Vec3(1, 0, -1));
    asItIs.fix.meshUp = "w";
    EXPECT_NE(test::messageOf([&] { load(asItIs); }).find("--mesh-up: expected \"x\""), std::string::npos);
    file["up"] = "y";
    EXPECT_EQ(load().mesh.positions[2], Vec3(1, 1, 0));  // as the cameras
    Progress progress;
    EXPECT_THROW(captureFiles(folder.path(), {}, progress).refuse(folder / "mesh.bin"), Error);
}

/// A mesh that lies on its side beside the cameras is noticed by what the photographs say of its places.
TEST_F(LoadCapture, OffersTheUpThatPhotographsSpeakFor) {
    test::paintKnownWorld(folder / "room", true, 6, 16);
    Progress progress;
    const auto warnings = [&](const std::string& meshUp) {
        LoadOptions options;
        options.fix.meshUp = meshUp;
        return checkCapture(loadCapture(folder / "room", options, progress), progress).warnings;
    };
    EXPECT_FALSE(anyHolds(warnings(""), "--mesh-up"));
    EXPECT_TRUE(anyHolds(warnings("y"), "--mesh-up z"));
}

TEST_F(LoadCapture, NamesTheFrameWhoseImageIsMissing) {
    file["frames"][1]["file_path"] = "images/c.exr";
    EXPECT_EQ(error(), "transforms.json: frame 1: " + (folder / "images/c.exr").string() + ": does not exist");
}

TEST_F(LoadCapture, NamesTheFrameWhoseImageIsUnreadable) {
    folder.write("images/b.exr", "no image");
    EXPECT_NE(
        error().find("transforms.json: frame 1: " + (folder / "images/b.exr").string() + ": is not a readable image"),
        std::string::npos);
}

TEST_F(LoadCapture, NamesTheSizesWhenAnImageHasAnother) {
    writeImage(folder / "images/b.exr", Image(12, 16));
    EXPECT_EQ(error(), "transforms.json: frame 1: " + (folder / "images/b.exr").string() +
                           ": is 12 x 16 pixels, w and h say 16 x 12");
}

TEST_F(LoadCapture, FindsImagesWithoutEndingAndWithBackslashes) {
    file["frames"][0]["file_path"] = "./images/a";
    file["frames"][1]["file_path"] = "images\\b.exr";
    file.erase("w");
    file.erase("h");
    EXPECT_EQ(load().views[1].camera.width, 16);
}

TEST_F(LoadCapture, BadPixelsAreCountedInTheNotes) {
    Image image(16, 12, Rgb(1));
    image.at(0, 0).x = std::numeric_limits<float>::quiet_NaN();
    image.at(1, 0).y = std::numeric_limits<float>::infinity();
    image.at(2, 0).z = -1;
    writeImage(folder / "images/b.exr", image);
    const Capture capture = load();
    ASSERT_EQ(capture.notes.size(), 1u);
    EXPECT_EQ(capture.notes[0], "images/b.exr: 1 NaN, 1 infinite and 1 negative pixels are left out.");
    EXPECT_FALSE(capture.views[1].image.usableAt(0, 0));
}

TEST_F(LoadCapture, PhotographsOfNothingButNanAreWhatTheCheckWarnsOf) {
    const Image broken(16, 12, Rgb(std::numeric_limits<float>::quiet_NaN()));
    writeImage(folder / "images/a.exr", broken);
    Progress progress;
    EXPECT_FALSE(anyHolds(checkCapture(load(), progress).warnings, "No photograph has a pixel that can be used"));
    writeImage(folder / "images/b.exr", broken);
    const CaptureCheck check = checkCapture(load(), progress);
    ASSERT_EQ(check.warnings.size(), 1u) << "and of nothing else: poses and mesh may be right";
    EXPECT_NE(check.warnings[0].find("No photograph has a pixel that can be used"), std::string::npos);
}

TEST_F(LoadCapture, BlackAndClippedImagesAreNotedAndNotRefused) {
    writeImage(folder / "images/a.exr", Image(16, 12));
    writeImage(folder / "images/b.png", Image(16, 12, Rgb(2)));
    file["frames"][1]["file_path"] = "images/b.png";
    const Capture capture = load();
    EXPECT_TRUE(anyHolds(capture.notes, "images/a.exr: is black all over."));
    EXPECT_TRUE(anyHolds(capture.notes, "images/b.png: is clipped all over."));
    EXPECT_NEAR(capture.views[1].saturation, 0.99f, 1e-6);
}

TEST_F(LoadCapture, MasksOfEitherNameAreApplied) {
    Image mask(16, 12, Rgb(1));
    mask.at(4, 5) = Rgb(0);
    std::filesystem::create_directories(folder / "masks");
    writeImage(folder / "masks/a.exr.png", mask);
    mask.at(6, 7) = Rgb(0);
    writeImage(folder / "images/b_mask.png", mask);
    const Capture capture = load();
    EXPECT_FALSE(capture.views[0].image.usableAt(4, 5));
    EXPECT_TRUE(capture.views[0].image.usableAt(6, 7));
    EXPECT_FALSE(capture.views[1].image.usableAt(6, 7));
    EXPECT_EQ(capture.views[0].image.at(4, 5), Rgb(0.5f));
    EXPECT_TRUE(anyHolds(capture.notes, "images/b.exr: 2 pixels are masked."));
    writeImage(folder / "masks/a.exr.png", Image(8, 6, Rgb(1)));
    EXPECT_NE(error().find("a.exr.png: is 8 x 6 pixels, its image is 16 x 12"), std::string::npos);
}

TEST_F(LoadCapture, MasksThatTheFileNamesAreApplied) {
    Image mask(16, 12, Rgb(1));
    mask.at(4, 5) = Rgb(0);
    std::filesystem::create_directories(folder / "masks");
    writeImage(folder / "masks/first.png", mask);
    file["frames"][0]["mask_path"] = "masks/first.png";
    const Capture capture = load();
    EXPECT_FALSE(capture.views[0].image.usableAt(4, 5));
    EXPECT_TRUE(capture.views[1].image.usableAt(4, 5));
    Progress progress;
    EXPECT_THROW(captureFiles(folder.path(), {}, progress).refuse(folder / "masks/first.png"), Error);
    // The same mask by its usual name is one mask.
    writeImage(folder / "masks/b.exr.png", mask);
    file["frames"][1]["mask_path"] = "./masks/b.exr.png";
    EXPECT_TRUE(anyHolds(load().notes, "images/b.exr: 1 pixels are masked."));
    file["frames"][0]["mask_path"] = "masks/absent.png";
    EXPECT_NE(error().find("masks/absent.png"), std::string::npos);
    file["frames"][0]["mask_path"] = 5;
    EXPECT_EQ(error(), "transforms.json: frame 0: mask_path is a number, expected text");
}

TEST_F(LoadCapture, OnePhotographIsReadAsAllAre) {
    Image mask(16, 12, Rgb(1));
    mask.at(4, 5) = Rgb(0);
    writeImage(folder / "images/b_mask.png", mask);
    writeImage(folder / "images/b.png", Image(16, 12, Rgb(0.3f)));
    file["frames"][1]["file_path"] = "images/b.png";
    const Capture capture = load();
    std::filesystem::remove(folder / "images/a.exr");  // the others are not looked at
    Progress progress;
    const PhotographReader reader(folder.path(), {}, progress);
    ASSERT_EQ(reader.count(), 2u);
    std::vector<std::string> notes;
    const View view = reader.read(1, notes, progress);
    EXPECT_EQ(view.image.pixels, capture.views[1].image.pixels);
    EXPECT_EQ(view.image.usable, capture.views[1].image.usable);
    EXPECT_EQ(view.saturation, capture.views[1].saturation);
    EXPECT_GT(view.saturation, 0.9f);
    EXPECT_EQ(notes, capture.notes);
    EXPECT_EQ(test::messageOf([&] { reader.read(0, notes, progress); }),
              "transforms.json: frame 0: " + (folder / "images/a.exr").string() + ": does not exist");
    progress.requestStop();
    EXPECT_THROW(reader.read(1, notes, progress), Cancelled);
}

TEST_F(LoadCapture, MissingFilesAreNamed) {
    Progress progress;
    EXPECT_EQ(test::messageOf([&] { loadCapture(folder.path(), {}, progress); }),
              (folder / "transforms.json").string() +
                  ": does not exist, and no other cameras are found; a capture has " + captureMarks());
    EXPECT_EQ(test::messageOf([&] { loadCapture(folder / "none", {}, progress); }),
              (folder / "none").string() + ": does not exist");
    EXPECT_EQ(test::messageOf([&] { loadCapture(folder / "mesh.obj", {}, progress); }),
              (folder / "mesh.obj").string() + ": is not a folder");
    file["mesh_path"] = "model.ply";
    EXPECT_EQ(error(),
              "transforms.json: mesh_path names " + (folder / "model.ply").string() + ", which does not exist");
    file.erase("mesh_path");
    std::filesystem::remove(folder / "mesh.obj");
    EXPECT_NE(error().find("mesh_path is missing"), std::string::npos);
}

TEST_F(LoadCapture, StopsWhenAsked) {
    folder.write("transforms.json", file.dump());
    Progress progress;
    progress.requestStop();
    EXPECT_THROW(loadCapture(folder.path(), {}, progress), Cancelled);
}

TEST_F(LoadCapture, TheDoctorFindsNothingWrongWithViewsThatAgree) {
    Progress progress;
    const CaptureCheck check = checkCapture(load(), progress);
    ASSERT_EQ(check.views.size(), 2u);
    // 12 pixels of focal length, 2 m away: the square of 2 m covers 12 x 12 of 16 x 12 pixels.
    EXPECT_NEAR(check.views[0].meshFraction, 0.75, 1e-6);
    EXPECT_NEAR(check.views[0].meanRadiance, 0.5, 1e-6);
    EXPECT_EQ(check.views[0].maskedFraction, 0);
    EXPECT_EQ(check.upGuess, "y");
    EXPECT_FALSE(check.lookBackwards);
    EXPECT_EQ(toJson(check)["views"][1]["name"], "images/b.exr");
    EXPECT_NE(toText(check).find("images/a.exr"), std::string::npos);
}

TEST_F(LoadCapture, TheDoctorFindsTheViewOfAnotherExposure) {
    std::string mesh;
    for (int y = 0; y < 20; ++y)
        for (int x = 0; x < 20; ++x) mesh += fmt::format("v {} {} 0\n", x / 10.0 - 0.95, y / 16.0 - 0.6);
    for (int y = 1; y < 20; ++y)
        for (int x = 1; x < 20; ++x)
            mesh += fmt::format("f {} {} {} {}\n", y * 20 + x - 20, y * 20 + x - 19, y * 20 + x + 1, y * 20 + x);
    folder.write("mesh.obj", mesh);
    file["frames"].push_back(file["frames"][0]);
    writeImage(folder / "images/b.exr", Image(16, 12, Rgb(1.0f)));
    Progress progress;
    const CaptureCheck check = checkCapture(load(), progress);
    EXPECT_NEAR(check.views[1].exposureStops, 1, 0.1);
    EXPECT_NEAR(check.views[0].exposureStops, 0, 0.1);
    EXPECT_TRUE(anyHolds(check.warnings, "images/b.exr: is"));
    EXPECT_EQ(check.seenTwiceFraction, 1);
}

TEST_F(LoadCapture, TheDoctorKnowsAnObjectBeforeABlackBackground) {
    Progress progress;
    EXPECT_FALSE(checkCapture(load(), progress).backdrop);
    // The square covers the middle 12 x 12 of 16 x 12 pixels.
    Image cut(16, 12, Rgb(0.5f));
    for (int y = 0; y < 12; ++y)
        for (int x : {0, 1, 14, 15}) cut.at(x, y) = Rgb(0.01f);
    for (const char* name : {"images/a.exr", "images/b.exr"}) writeImage(folder / name, cut);
    const CaptureCheck check = checkCapture(load(), progress);
    EXPECT_TRUE(check.backdrop);
    EXPECT_EQ(check.views[0].lightFraction, 0);
    EXPECT_TRUE(anyHolds(check.warnings, "before a masked or black background"));
}

TEST_F(LoadCapture, TheDoctorSeesCamerasWithOpenCvAxes) {
    for (auto& frame : file["frames"])
        frame["transform_matrix"] = {{1, 0, 0, 0}, {0, -1, 0, 0}, {0, 0, -1, 2}, {0, 0, 0, 1}};
    Progress progress;
    const CaptureCheck check = checkCapture(load(), progress);
    EXPECT_TRUE(check.lookBackwards);
    EXPECT_TRUE(anyHolds(check.warnings, "OpenCV"));
}

}  // namespace
}  // namespace relamp
