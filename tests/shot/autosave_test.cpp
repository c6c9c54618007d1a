#include "shot/autosave.h"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include "support/temporary_folder.h"

namespace relamp {
namespace {

using test::TemporaryFolder;

AutosavedWork workOf(float yaw) {
    AutosavedWork work;
    work.captureFolder = "/captures/desk";
    work.look.environment.yawDegrees = yaw;
    work.look.parts = {{7, Mat4(1), "emitter-1"}};
    work.steps = {{"Opened", {}}, {"Turn", work.look}};
    work.stage = "estimating";
    return work;
}

/// Another process writes and is killed without warning.
void writeAndDie(const std::filesystem::path& folder, const AutosavedWork& work) {
    const pid_t child = fork();
    ASSERT_GE(child, 0);
    if (child == 0) {
        Autosave autosave(folder);
        autosave.write(work);
        kill(getpid(), SIGKILL);
    }
    int status = 0;
    waitpid(child, &status, 0);
    EXPECT_TRUE(WIFSIGNALED(status));
}

TEST(Autosave, whatAKilledProcessWroteIsFound) {
    const TemporaryFolder folder;
    writeAndDie(folder.path(), workOf(33));
    const Autosave mine(folder.path());
    const std::vector<FoundWork> lost = mine.findLost();
    ASSERT_EQ(lost.size(), 1u);
    EXPECT_EQ(lost[0].work.captureFolder, "/captures/desk");
    EXPECT_EQ(lost[0].work.look.environment.yawDegrees, 33);
    EXPECT_EQ(lost[0].work.look.parts.at(0).attachedTo, "emitter-1");
    EXPECT_EQ(lost[0].work.stage, "estimating");
    ASSERT_EQ(lost[0].work.steps.size(), 2u);
    EXPECT_EQ(lost[0].work.steps[0].label, "Opened");
    EXPECT_EQ(lost[0].work.steps[0].look, Look{});
    EXPECT_EQ(lost[0].work.steps[1].look, lost[0].work.look);
    EXPECT_EQ(lost[0].work.time.size(), 19u);
    Autosave::discard(lost[0]);
    EXPECT_TRUE(mine.findLost().empty());
    EXPECT_EQ(folder.entries(), 1u);  // my lock
}

TEST(Autosave, theWorkOfALivingProcessIsNotOffered) {
    const TemporaryFolder folder;
    Autosave first(folder.path()), second(folder.path());
    first.write(workOf(1));
    EXPECT_TRUE(second.findLost().empty());
    EXPECT_TRUE(first.findLost().empty());
}

TEST(Autosave, clearedWorkIsNotOfferedAndNothingIsLeftBehind) {
    const TemporaryFolder folder;
    {
        Autosave one(folder.path());
        one.write(workOf(1));
        std::filesystem::create_directories(one.estimateFolder(1));
        one.clear();
    }
    EXPECT_EQ(folder.entries(), 0u);
}

TEST(Autosave, damagedFilesAreSkipped) {
    const TemporaryFolder folder;
    writeAndDie(folder.path(), workOf(5));
    folder.write("work-1-0.autosave.json", "{\"capture\": 3");
    folder.write("work-2-0.autosave.json", "{\"capture\": 3}");
    folder.write("work-3-0.autosave.json", "");
    const Autosave mine(folder.path());
    EXPECT_EQ(mine.findLost().size(), 1u);
}

TEST(Autosave, aFolderThatCannotBeMadeLeavesItOff) {
    const TemporaryFolder folder;
    folder.write("file", "");
    Autosave autosave(folder / "file");
    EXPECT_FALSE(autosave.working());
    EXPECT_NO_THROW(autosave.write(workOf(1)));
    EXPECT_TRUE(autosave.findLost().empty());
}

}  // namespace
}  // namespace relamp
