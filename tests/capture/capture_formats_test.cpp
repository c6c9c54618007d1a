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

/// Whoever looks a program up in one of the documents finds it there.
TEST(CaptureFormats, StandInEveryDocumentThatListsThem) {
    const struct {
        const char* document;
        bool inGuide;
    } documents[] = {{"core/capture/FORMAT.md", false}, {"README.md", false}, {"docs/guide.md", true}};
    for (const auto& [document, inGuide] : documents) {
        const std::string text = TemporaryFolder::read(fs::path(RELAMP_SOURCE_DIR) / document);
        ASSERT_FALSE(text.empty()) << document;
        for (const CaptureFormat& format : captureFormats()) {
            // The program's name: what the row's name begins with.
            std::string program = format.name;
            for (const char* kind : {" cameras", " scan", " model", " poses"})
                if (const size_t at = program.find(kind); at != std::string::npos) program.resize(at);
            const size_t list = inGuide ? text.find("## Where captures come from") : 0;
            ASSERT_NE(list, std::string::npos);
            EXPECT_NE(text.find(program, list), std::string::npos) << document << " does not name " << program;
        }
    }
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

TEST(CaptureFormats, OtherProgramsFilesAreKnownByTheirContent) {
    const TemporaryFolder folder;
    const struct {
        const char *file, *content, *format;
    } files[] = {
        {"cameras.xml", "<?xml version=\"1.0\"?><document version=\"2.0.0\"><chunk>", "Metashape cameras"},
        {"any.xml", "<document><chunk label=\"1\">", "Metashape cameras"},
        {"cameras.sfm", "{\"version\": [\"1\"], \"views\": []}", "Meshroom cameras"},
        {"cameras.csv", "#name,x,y,alt,heading,pitch,roll,f\n", "RealityCapture cameras"},
        {"bundle/bundle.out", "# Bundle file v0.3\n", "Bundler cameras"},
        {"sfm_data.json", "{\"sfm_data_version\": \"0.3\"}", "OpenMVG cameras"},
        {"a.nvm", "NVM_V3\n", "VisualSFM cameras"},
        {"poses_bounds.npy", "\x93NUMPY", "LLFF poses"},
        {"keyframes/cameras/1.json", "{\"t_00\": 1}", "Polycam scan"},
        {"metadata.json", "{\"h\": 3, \"K\": []}", "Record3D scan"},
        {"frame_00000.json", "{\"cameraPoseARFrame\": []}", "3D Scanner App scan"},
    };
    std::set<std::string> found;
    for (const auto& [file, content, format] : files) {
        const std::string room = fmt::format("room{}", found.size());
        found.insert(room);
        folder.write(room + "/" + file, content);
        EXPECT_EQ(formatOf(folder / room), format) << file;
        // Another content under the same name is nobody's.
        folder.write(room + "/" + file, "something else");
        EXPECT_EQ(formatOf(folder / room), "") << file;
        folder.write(room + "/" + file, "");
        EXPECT_EQ(formatOf(folder / room), "") << file;
        // What relamp itself writes counts before them.
        folder.write(room + "/" + file, content);
        folder.write(room + "/transforms.json", "{}");
        EXPECT_EQ(formatOf(folder / room), "transforms.json") << file;
    }
    EXPECT_EQ(found.size(), captureFormats().size() - 1) << "a row has no file here, or two";
}

TEST(CaptureFormats, TheUsualNameCountsThenTheFirst) {
    const TemporaryFolder folder;
    for (const char* name : {"b.nvm", "a.nvm", "c.nvm"}) folder.write(name, "NVM_V3\n");
    EXPECT_EQ(findCapture(folder.path())->cameras, folder / "a.nvm");
    folder.write("reconstruction.nvm", "NVM_V3\n");
    EXPECT_EQ(findCapture(folder.path())->cameras, folder / "reconstruction.nvm");
    folder.write("part/bundle/bundle.out", "# Bundle file v0.3\n");
    EXPECT_EQ(captureFolderOf(folder / "part/bundle/bundle.out"), folder / "part");
    EXPECT_EQ(captureFolderOf(folder / "b.nvm"), folder.path());
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
