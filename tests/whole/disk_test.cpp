// Disks that are full or may not be written, photographs that go away: a sentence that names the file, and nothing
// lost.
#include <gtest/gtest.h>
#include <unistd.h>

#include <thread>

#include "shot/shot_file.h"
#include "support/known_world.h"
#include "support/run_program.h"

namespace relamp {
namespace {

namespace fs = std::filesystem;
using test::ProgramResult;
using test::TemporaryFolder;

/// A capture and its shot, made once; each test has copies.
class Disk : public testing::Test {
protected:
    static void SetUpTestSuite() {
        made = new TemporaryFolder;
        test::paintSmallWorld(*made / "room");
        firstSolve = relamp({"solve", *made / "room", "-o", *made / "room.relamp", "--quality", "draft"});
    }
    static void TearDownTestSuite() { delete made; }
    void SetUp() override {
        ASSERT_EQ(firstSolve.exitCode, 0) << firstSolve.error;
        for (const char* name : {"room", "room.relamp"})
            fs::copy(*made / name, folder / name, fs::copy_options::recursive);
        before = TemporaryFolder::read(folder / "room.relamp/shot.json");
    }
    std::string shot() const { return folder / "room.relamp"; }
    static ProgramResult relamp(std::vector<std::string> arguments) {
        arguments.insert(arguments.begin(), RELAMP_BINARY);
        return test::runProgram(arguments);
    }
    /// Through a shell that runs `first` before it.
    static ProgramResult after(const std::string& first, const std::vector<std::string>& arguments) {
        std::string line = first + "; exec '" RELAMP_BINARY "'";
        for (const std::string& a : arguments) line += " '" + a + "'";
        return test::runProgram({"/bin/sh", "-c", line});
    }
    std::vector<fs::path> frames() const {
        std::vector<fs::path> found;
        for (const auto& entry : fs::directory_iterator(folder.path()))
            if (entry.path().extension() == ".exr") found.push_back(entry.path());
        return found;
    }
    void expectTheOldShot() const {
        EXPECT_EQ(TemporaryFolder::read(folder / "room.relamp/shot.json"), before);
        Progress progress;
        EXPECT_NO_THROW(openShot(shot(), true, progress));
    }
    static inline TemporaryFolder* made = nullptr;
    static inline ProgramResult firstSolve;
    TemporaryFolder folder;
    std::string before;
};

TEST_F(Disk, filesThatMayNotGrowAreNamedAndTheOldOnesStay) {
    const std::string limit = "ulimit -f 8";
    const ProgramResult solved =
        after(limit, {"solve", folder / "room", "-o", shot(), "--quality", "draft", "--overwrite", "--seed", "2"});
    EXPECT_EQ(solved.exitCode, 6) << solved.error;
    EXPECT_NE(solved.error.find("room.relamp"), std::string::npos) << solved.error;
    expectTheOldShot();
    const ProgramResult frame =
        after(limit, {"render", shot(), "-o", folder / "f.exr", "--samples", "1", "--layers", "all"});
    EXPECT_EQ(frame.exitCode, 6) << frame.error;
    EXPECT_NE(frame.error.find("f.exr: cannot be written"), std::string::npos) << frame.error;
    const ProgramResult layered =
        after(limit, {"render", shot(), "-o", folder / "m.exr", "--samples", "1", "--layers", "all", "--multipart"});
    EXPECT_EQ(layered.exitCode, 6) << layered.error;
    EXPECT_NE(layered.error.find("m.exr"), std::string::npos) << layered.error;
    const ProgramResult image =
        after(limit, {"render", shot(), "-o", folder / "p.png", "--samples", "1", "--size", "320x240"});
    EXPECT_EQ(image.exitCode, 6) << image.error;
    EXPECT_NE(image.error.find("p.png"), std::string::npos) << image.error;
    const ProgramResult exported = after(limit, {"export", shot(), "-o", folder / "scene"});
    EXPECT_EQ(exported.exitCode, 6) << exported.error;
    EXPECT_NE(exported.error.find("scene/"), std::string::npos) << exported.error;
    for (const auto& entry : fs::recursive_directory_iterator(folder.path()))
        EXPECT_NE(entry.path().filename().string()[0], '.') << "left behind: " << entry.path();
    EXPECT_EQ(folder.entries(), size_t(fs::exists(folder / "scene") ? 3 : 2));
}

TEST_F(Disk, aFullDiskEndsASequenceWithWhatFits) {
    // A small file system of its own, where this user may make one.
    const std::string own = "mount -t tmpfs -o size=600k none '" + (folder / "small").string() + "'";
    fs::create_directories(folder / "small");
    if (test::runProgram({"/usr/bin/unshare", "--map-root-user", "--mount", "/bin/sh", "-c", own}).exitCode != 0)
        GTEST_SKIP() << "no file system of one's own can be mounted here";
    const std::string line = own + " && '" RELAMP_BINARY "' render '" + shot() + "' -o '" +
                             (folder / "small/f.##.exr").string() +
                             "' --camera turntable:8 --samples 1 --layers all --size 160x120; code=$?; cp -r '" +
                             (folder / "small").string() + "' '" + (folder / "copy").string() + "'; exit $code";
    const ProgramResult result =
        test::runProgram({"/usr/bin/unshare", "--map-root-user", "--mount", "/bin/sh", "-c", line});
    EXPECT_EQ(result.exitCode, 5) << result.error;
    EXPECT_NE(result.error.find("No space left"), std::string::npos) << result.error;
    EXPECT_NE(result.error.find("small/f."), std::string::npos) << result.error;
    size_t frames = 0;
    for (const auto& entry : fs::directory_iterator(folder / "copy")) {
        EXPECT_NO_THROW(readImage(entry.path())) << entry.path();
        ++frames;
    }
    EXPECT_GT(frames, 0u);
    EXPECT_LT(frames, 8u);
}

TEST_F(Disk, foldersThatMayNotBeWrittenAreToldBeforeTheWork) {
    // Root may write everywhere: then somebody else tries.
    std::vector<std::string> somebody;
    if (geteuid() == 0) somebody = {"/usr/bin/setpriv", "--reuid=65534", "--regid=65534", "--clear-groups"};
    fs::permissions(folder.path(), fs::perms(0555));
    const auto as = [&](std::vector<std::string> arguments) {
        std::vector<std::string> line = somebody;
        line.push_back(RELAMP_BINARY);
        line.insert(line.end(), arguments.begin(), arguments.end());
        return test::runProgram(line);
    };
    if (as({"--version"}).exitCode != 0) GTEST_SKIP() << "another user cannot run the program here";
    const ProgramResult solved =
        as({"--progress", "json", "solve", folder / "room", "-o", folder / "new.relamp", "--quality", "draft"});
    EXPECT_EQ(solved.exitCode, 3) << solved.error;
    EXPECT_NE(solved.error.find("new.relamp: cannot be written"), std::string::npos) << solved.error;
    EXPECT_EQ(solved.error.find("\"stage\""), std::string::npos) << "nothing was calculated first";
    const ProgramResult frame = as({"render", shot(), "-o", folder / "f.exr", "--samples", "1", "--size", "16x12"});
    EXPECT_EQ(frame.exitCode, 3) << frame.error;
    EXPECT_NE(frame.error.find("f.exr"), std::string::npos) << frame.error;
    const ProgramResult exported = as({"export", shot(), "-o", folder / "scene"});
    EXPECT_EQ(exported.exitCode, 3) << exported.error;
    EXPECT_NE(exported.error.find("scene"), std::string::npos) << exported.error;
    fs::permissions(folder.path(), fs::perms(0755));
    expectTheOldShot();
}

TEST_F(Disk, photographsThatGoAwayAreNamed) {
    // The disk is pulled after a while, longer each time, until it comes too late to matter.
    for (const std::vector<std::string>& job :
         {std::vector<std::string>{"solve", folder / "room", "-o", folder / "new.relamp", "--quality", "draft",
                                   "--overwrite"},
          std::vector<std::string>{"render", shot(), "-o", folder / "f.##.exr", "--camera", "all", "--ratio",
                                   "--samples", "1"}}) {
        int failed = 0, done = 0;
        for (int delay = 0; delay < 600'000 && !done; delay = delay * 3 + 4) {
            std::thread pulls([&] {
                std::this_thread::sleep_for(std::chrono::milliseconds(delay));
                fs::rename(folder / "room/images", folder / "room/gone");
            });
            for (const fs::path& frame : frames()) fs::remove(frame);
            const ProgramResult result = relamp(job);
            pulls.join();
            fs::rename(folder / "room/gone", folder / "room/images");
            if (result.exitCode == 0) {
                ++done;
                continue;
            }
            ++failed;
            // Frames whose photographs were read before are there.
            EXPECT_EQ(result.exitCode, frames().empty() ? 3 : 5) << result.error;
            EXPECT_NE(result.error.find("images/"), std::string::npos) << result.error;
        }
        EXPECT_GT(failed, 0);
        EXPECT_EQ(done, 1);
        expectTheOldShot();
    }
}

TEST_F(Disk, twoSolvesOfOneShotDoNotOverwriteEachOther) {
    std::thread first([&] {
        EXPECT_EQ(relamp({"solve", folder / "room", "-o", folder / "twice.relamp", "--quality", "standard"}).exitCode,
                  0);
    });
    while (!fs::exists(folder / ".twice.relamp.lock")) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    const ProgramResult second =
        relamp({"solve", folder / "room", "-o", folder / "twice.relamp", "--quality", "draft", "--overwrite"});
    first.join();
    EXPECT_EQ(second.exitCode, 3) << second.error;
    EXPECT_NE(second.error.find("is open elsewhere"), std::string::npos) << second.error;
    EXPECT_FALSE(fs::exists(folder / ".twice.relamp.lock"));
}

}  // namespace
}  // namespace relamp
