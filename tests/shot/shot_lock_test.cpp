#include "shot/shot_lock.h"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include "support/temporary_folder.h"

namespace relamp {
namespace {

namespace fs = std::filesystem;
using test::TemporaryFolder;

TEST(ShotLock, theSecondIsToldWhoHasIt) {
    const TemporaryFolder folder;
    ShotLock first = ShotLock::take(folder / "a.relamp");
    ASSERT_TRUE(first.held());
    EXPECT_EQ(first.owner(), "");
    const ShotLock second = ShotLock::take(folder / "a.relamp/");
    EXPECT_FALSE(second.held());
    EXPECT_NE(second.owner().find("process " + std::to_string(getpid())), std::string::npos) << second.owner();
    EXPECT_TRUE(ShotLock::take(folder / "b.relamp").held());
    first.release();
    EXPECT_TRUE(ShotLock::take(folder / "a.relamp").held());
    EXPECT_EQ(folder.entries(), 0u) << "nothing is left behind";
}

TEST(ShotLock, anotherWayToTheSameFolderIsTheSameLock) {
    const TemporaryFolder folder;
    fs::create_directories(folder / "a.relamp");
    fs::create_symlink(folder / "a.relamp", folder / "other");
    const ShotLock first = ShotLock::take(folder / "a.relamp");
    EXPECT_NE(ShotLock::take(folder / "other").owner(), "");
}

TEST(ShotLock, aKilledProcessFreesIt) {
    const TemporaryFolder folder;
    const pid_t child = fork();
    if (child == 0) {
        const ShotLock lock = ShotLock::take(folder / "a.relamp");
        kill(getpid(), SIGKILL);
    }
    int status = 0;
    waitpid(child, &status, 0);
    ASSERT_TRUE(WIFSIGNALED(status));
    EXPECT_EQ(folder.entries(), 1u);
    EXPECT_TRUE(ShotLock::take(folder / "a.relamp").held());
    EXPECT_EQ(folder.entries(), 0u);
}

TEST(ShotLock, itMovesWithItsObject) {
    const TemporaryFolder folder;
    ShotLock first = ShotLock::take(folder / "a.relamp"), second = std::move(first);
    EXPECT_TRUE(second.held());
    second = ShotLock::take(folder / "b.relamp");
    EXPECT_TRUE(ShotLock::take(folder / "a.relamp").held());
    EXPECT_FALSE(ShotLock::take(folder / "b.relamp").held());
}

TEST(ShotLock, aLinkInItsPlaceIsNotFollowed) {
    const TemporaryFolder folder;
    folder.write("letter", "dear");
    std::filesystem::create_symlink("letter", folder / ".a.relamp.lock");
    EXPECT_FALSE(ShotLock::take(folder / "a.relamp").held());
    EXPECT_EQ(TemporaryFolder::read(folder / "letter"), "dear");
}

TEST(ShotLock, whereNothingCanBeWrittenItIsNoparts) {
    const TemporaryFolder folder;
    const ShotLock lock = ShotLock::take(folder / "not/there/a.relamp");
    EXPECT_FALSE(lock.held());
    EXPECT_EQ(lock.owner(), "");
}

}  // namespace
}  // namespace relamp
