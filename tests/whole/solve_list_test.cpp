// relamp solve --list and the scripts that put it on a farm.
#include <gtest/gtest.h>

#include "support/known_world.h"
#include "support/run_program.h"
#include "whole/relamp_program.h"

namespace relamp {
namespace {

namespace fs = std::filesystem;

class SolveList : public testing::Test {
protected:
    void SetUp() override {
        test::paintSmallWorld(folder / "room");
        list = folder.write("list.txt", "# the day's captures\nroom\n\n  gone \t third\nroom\tsecond\n");
    }
    test::ProgramResult solve(std::vector<std::string> more) const {
        more.insert(more.begin(), {"solve", "--list", list, "-o", folder / "shots", "--quality", "draft"});
        return test::relamp(more);
    }
    test::TemporaryFolder folder;
    fs::path list;
};

TEST_F(SolveList, GoesOnAfterACaptureThatFailsAndLeavesWhatIsThere) {
    const test::ProgramResult r = solve({"--items", "1-2,9", "--accept-poor"});
    EXPECT_EQ(r.exitCode, 5) << r.error;
    EXPECT_NE(r.error.find("line 4: "), std::string::npos) << r.error;
    EXPECT_NE(r.error.find("1 of them outside the list of 3 captures"), std::string::npos) << r.error;
    EXPECT_TRUE(fs::exists(folder / "shots/room.relamp/shot.json"));
    EXPECT_FALSE(fs::exists(folder / "shots/third.relamp"));
    EXPECT_FALSE(fs::exists(folder / "shots/second.relamp"));
    EXPECT_EQ(test::relamp({"info", folder / "shots/room.relamp"}).exitCode, 0);
    // A task of a farm that is run again finds its shot.
    const auto written = fs::last_write_time(folder / "shots/room.relamp/shot.json");
    const std::string job = RELAMP_SOURCE_DIR "/assets/farm/relamp-solve.sbatch";
    const test::ProgramResult again =
        test::runProgram({"/usr/bin/env", "RELAMP=" RELAMP_BINARY, "SLURM_ARRAY_TASK_ID=1", "/bin/bash", job, list,
                          folder / "shots", "--quality", "draft"});
    EXPECT_EQ(again.exitCode, 0) << again.error;
    EXPECT_NE(again.error.find("exists, skipped"), std::string::npos) << again.error;
    EXPECT_EQ(fs::last_write_time(folder / "shots/room.relamp/shot.json"), written);
    // Without --skip-existing a shot is not replaced.
    EXPECT_EQ(solve({"--items", "1"}).exitCode, 3);
}

TEST_F(SolveList, BadListsAreNamedByTheirLine) {
    const auto said = [&](const std::string& text) {
        folder.write("list.txt", text);
        const test::ProgramResult r = solve({});
        EXPECT_EQ(r.exitCode, 3) << r.error;
        return r.error;
    };
    EXPECT_NE(said("room\n\nother/room\n").find("line 3: room.relamp is the shot of line 1"), std::string::npos);
    EXPECT_NE(said("# nothing\n").find("names no capture"), std::string::npos);
    EXPECT_NE(said("room\t../up\n").find("line 1: a shot's name"), std::string::npos);
    EXPECT_NE(said("gone\n").find("gone"), std::string::npos);
    EXPECT_EQ(solve({"--items", "2-1"}).exitCode, 2);
    EXPECT_EQ(test::relamp({"solve", "-o", folder / "x.relamp"}).exitCode, 2);
    EXPECT_EQ(test::relamp({"solve", folder / "room", "-o", folder / "x.relamp", "--items", "1"}).exitCode, 2);
    EXPECT_EQ(solve({folder / "room"}).exitCode, 2);
}

TEST_F(SolveList, OpenCueGetsAFrameACapture) {
    const test::ProgramResult r =
        test::runProgram({"/usr/bin/python3", RELAMP_SOURCE_DIR "/assets/farm/relamp_solve_opencue.py", list, "shots",
                          "--dry-run", "--", "--quality", "draft"});
    EXPECT_EQ(r.exitCode, 0) << r.error;
    EXPECT_EQ(r.out, "1-3 relamp --progress none solve --list " + list.string() +
                         " -o shots --items '#IFRAME#' --skip-existing --resume --quality draft\n");
}

}  // namespace
}  // namespace relamp
