#include "capture/capture_formats.h"

#include <gtest/gtest.h>

#include <set>

#include "support/temporary_folder.h"

namespace relamp {
namespace {
namespace fs = std::filesystem;
using test::TemporaryFolder;

std::string formatOf(const fs::path& folder) {
    const auto found = findCapture(folder);
    return found ? found->format->name : "";
}

TEST(CaptureFormats, HaveNamesOfTheirOwnAndStandInTheHint) {
    std::set<std::string> names;
    for (const CaptureFormat& format : captureFormats()) {
        EXPECT_TRUE(names.insert(format.name).second) << format.name;
        EXPECT_NE(captureMarks().find(format.marks), std::string::npos) << format.marks;
    }
    EXPECT_EQ(captureMarks().find("transforms.json"), 0u);
    EXPECT_NE(captureMarks().find(" or "), std::string::npos);
}

TEST(CaptureFormats, AreKnownByTheNamesInAFolder) {
    const TemporaryFolder folder;
    folder.write("nerf/transforms.json", "{}");
    folder.write("synthetic/transforms_train.json", "{}");
    for (const char* place : {"binary/sparse/0", "alone", "old/sparse", "other/colmap/sparse/0", "second/sparse/1"}) {
        folder.write(std::string(place) + "/cameras.bin", "x");
        folder.write(std::string(place) + "/images.bin", "x");
    }
    folder.write("text/sparse/0/cameras.txt", "x");
    folder.write("text/sparse/0/images.txt", "x");
    folder.write("plain/images/a.exr", "x");
    fs::create_directories(folder / "empty/sparse/0");
    EXPECT_EQ(formatOf(folder / "nerf"), "transforms.json");
    EXPECT_EQ(formatOf(folder / "synthetic"), "transforms.json");
    for (const char* room : {"binary", "alone", "old", "other", "second", "text"})
        EXPECT_EQ(formatOf(folder / room), "COLMAP model") << room;
    EXPECT_EQ(findCapture(folder / "binary")->cameras, folder / "binary/sparse/0");
    for (const char* none : {"plain", "empty", "absent"}) EXPECT_EQ(formatOf(folder / none), "") << none;
}

TEST(CaptureFormats, TheFirstOfTheTableIsReadWhereThereAreSeveral) {
    const TemporaryFolder folder;
    folder.write("transforms.json", "{}");
    folder.write("sparse/0/cameras.bin", "x");
    folder.write("sparse/0/images.bin", "x");
    EXPECT_EQ(formatOf(folder.path()), "transforms.json");
}

TEST(CaptureFormats, TheirFilesLeadToTheCaptureFolder) {
    const TemporaryFolder folder;
    folder.write("nerf/transforms.json", "{}");
    folder.write("room/sparse/0/cameras.bin", "x");
    folder.write("room/sparse/0/images.bin", "x");
    folder.write("images.bin", "x");
    EXPECT_EQ(captureFolderOf(folder / "nerf/transforms.json"), folder / "nerf");
    EXPECT_EQ(captureFolderOf(folder / "room/sparse/0/cameras.bin"), folder / "room");
    EXPECT_EQ(captureFolderOf(folder / "images.bin"), folder / "images.bin") << "there is no model beside it";
    EXPECT_EQ(captureFolderOf(folder / "room"), folder / "room");
    EXPECT_EQ(captureFolderOf(folder / "nerf/light.exr"), folder / "nerf/light.exr");
}

TEST(CaptureFormats, ErrorsNameTheFileThatWasRead) {
    const TemporaryFolder folder;
    folder.write("transforms_train.json", "{\"frames\": 3}");
    Progress progress;
    const std::string error = test::messageOf([&] { captureSource(folder.path(), {}, progress); });
    EXPECT_EQ(error.find("transforms_train.json: "), 0u) << error;
}

}  // namespace
}  // namespace relamp
