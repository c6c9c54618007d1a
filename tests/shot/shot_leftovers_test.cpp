#include "shot/shot_leftovers.h"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include "support/temporary_folder.h"

namespace relamp {
namespace {

namespace fs = std::filesystem;
using test::TemporaryFolder;

/// The number of a process that is gone.
std::string gone() {
    const pid_t child = fork();
    if (child == 0) _exit(0);
    waitpid(child, nullptr, 0);
    return std::to_string(child);
}

TEST(ShotLeftovers, whatIsNotOursGoesBackIntoTheShot) {
    const TemporaryFolder folder;
    const std::string left = ".a.relamp." + gone();
    folder.write("a.relamp/shot.json", "new");
    folder.write(left + "/shot.json", "old");
    folder.write(left + "/cache/cells", "old");
    folder.write(left + "/.shot.7.json", "half");
    folder.write(left + "/notes.txt", "mine");
    folder.write(left + "/renders/f.exr", "mine too");
    mendShot(folder / "a.relamp");
    EXPECT_EQ(folder.entries(), 1u);
    EXPECT_EQ(TemporaryFolder::read(folder / "a.relamp/shot.json"), "new");
    EXPECT_EQ(TemporaryFolder::read(folder / "a.relamp/notes.txt"), "mine");
    EXPECT_EQ(TemporaryFolder::read(folder / "a.relamp/renders/f.exr"), "mine too");
    EXPECT_FALSE(fs::exists(folder / "a.relamp/.shot.7.json"));
}

TEST(ShotLeftovers, nothingOfTheUsersIsWrittenOver) {
    const TemporaryFolder folder;
    const std::string left = ".a.relamp." + gone();
    folder.write("a.relamp/notes.txt", "new");
    folder.write(left + "/notes.txt", "old");
    mendShot(folder / "a.relamp/");
    EXPECT_EQ(TemporaryFolder::read(folder / "a.relamp/notes.txt"), "new");
    EXPECT_EQ(TemporaryFolder::read(folder / (left + "/notes.txt")), "old");
}

TEST(ShotLeftovers, aShotThatWasOnlyMovedAsideReturns) {
    const TemporaryFolder folder;
    const std::string number = gone();
    folder.write(".a.relamp." + number + ".old/shot.json", "old");
    folder.write(".a.relamp." + number + "/environment.exr", "unfinished: no shot.json yet");
    mendShot(folder / "a.relamp");
    EXPECT_EQ(TemporaryFolder::read(folder / "a.relamp/shot.json"), "old");
    EXPECT_EQ(folder.entries(), 1u);
    // Where the new one is whole, it is the new one.
    folder.write(".b.relamp." + number + ".old/shot.json", "old");
    folder.write(".b.relamp." + number + ".old/notes.txt", "mine");
    folder.write(".b.relamp." + number + "/shot.json", "new");
    mendShot(folder / "b.relamp");
    EXPECT_EQ(TemporaryFolder::read(folder / "b.relamp/shot.json"), "new");
    EXPECT_EQ(TemporaryFolder::read(folder / "b.relamp/notes.txt"), "mine");
    EXPECT_EQ(folder.entries(), 2u);
}

TEST(ShotLeftovers, livingProcessesAndOtherNamesAreLeftAlone) {
    const TemporaryFolder folder;
    const std::string number = gone();
    folder.write(".a.relamp." + std::to_string(getpid()) + "/x", "");
    folder.write(".b.relamp." + number + "/x", "");
    folder.write(".a.relamp.lock", "");
    folder.write(".a.relamp.backup/x", "");
    folder.write("a.relamp/shot.json", "");
    fs::create_directories(folder / (".a.relamp." + number));
    const FolderHold held(folder / (".a.relamp." + number));
    mendShot(folder / "a.relamp");
    EXPECT_EQ(folder.entries(), 6u);
    mendShot(folder / "nowhere/at/all");
}

}  // namespace
}  // namespace relamp
