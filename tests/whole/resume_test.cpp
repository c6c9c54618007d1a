// A solve that is killed goes on where it stood; plan and stress on the command line.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "shot/checkpoint.h"
#include "support/known_world.h"
#include "support/run_program.h"
#include "whole/relamp_program.h"

namespace relamp {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using test::relamp;
using test::TemporaryFolder;

struct KilledSolve {
    TemporaryFolder folder;
    std::string capture = folder / "capture", whole = folder / "whole.relamp", shot = folder / "not/yet/x.relamp";
    fs::path checkpoint = checkpointFile(shot);

    KilledSolve() { test::paintSmallWorld(folder / "capture", 6, 14); }
    std::vector<std::string> command(const std::string& output, bool resume = false) const {
        std::vector<std::string> c{"solve", capture, "-o", output, "--quality", "draft"};
        if (resume) c.push_back("--resume");
        return c;
    }
    void kill(int signalNumber = SIGKILL) {
        // The log speaks of the fine fit after the coarse one is put by.
        const test::ProgramResult killed = relamp(command(shot), "light from ratios: ", signalNumber);
        ASSERT_NE(killed.exitCode, 0) << "it ended before it could be killed";
        ASSERT_TRUE(fs::exists(checkpoint)) << killed.error;
        ASSERT_FALSE(fs::exists(shot));
    }
};

TEST(Killed, AResumedSolveEndsInTheSameBytes) {
    KilledSolve s;
    ASSERT_EQ(relamp(s.command(s.whole)).exitCode, 0);
    EXPECT_FALSE(fs::exists(checkpointFile(s.whole))) << "nothing is left after a solve that ended well";
    s.kill();
    const test::ProgramResult resumed = relamp(s.command(s.shot, true));
    ASSERT_EQ(resumed.exitCode, 0) << resumed.error;
    EXPECT_NE(resumed.error.find("going on after"), std::string::npos) << resumed.error;
    EXPECT_FALSE(fs::exists(s.checkpoint));
    for (const char* file : {"reflectance.ply", "environment.exr"})
        EXPECT_TRUE(TemporaryFolder::read(fs::path(s.shot) / file) == TemporaryFolder::read(fs::path(s.whole) / file))
            << file;
    const json a = json::parse(TemporaryFolder::read(fs::path(s.shot) / "shot.json")),
               b = json::parse(TemporaryFolder::read(fs::path(s.whole) / "shot.json"));
    EXPECT_EQ(a["emitters"], b["emitters"]);
    ASSERT_EQ(a["timeline"].size(), b["timeline"].size());
    for (size_t i = 0; i < a["timeline"].size(); ++i)
        EXPECT_EQ(a["timeline"][i]["objective"], b["timeline"][i]["objective"]);
}

TEST(Killed, AnInterruptedOneSaysSoAndLeavesACheckpointToo) {
    KilledSolve s;
    s.kill(SIGTERM);
    EXPECT_EQ(relamp(s.command(s.shot, true)).exitCode, 0);
}

TEST(Killed, ADamagedOrForeignCheckpointIsRefusedAndTheSolveStartsAnew) {
    KilledSolve s;
    s.kill();
    std::string bytes = TemporaryFolder::read(s.checkpoint);
    const std::string good = bytes;
    bytes[bytes.size() / 2] = char(bytes[bytes.size() / 2] ^ 1);
    const std::string name = "not/yet/" + s.checkpoint.filename().string();
    s.folder.write(name, bytes);
    const test::ProgramResult damaged = relamp(s.command(s.shot, true));
    EXPECT_EQ(damaged.exitCode, 0) << damaged.error;
    EXPECT_NE(damaged.error.find("is damaged; the solve starts anew"), std::string::npos) << damaged.error;
    s.folder.write(name, good);
    std::vector<std::string> other = s.command(s.shot, true);
    other.insert(other.end(), {"--overwrite", "--seed", "2"});
    const test::ProgramResult foreign = relamp(other);
    EXPECT_EQ(foreign.exitCode, 0) << foreign.error;
    EXPECT_NE(foreign.error.find("other options"), std::string::npos) << foreign.error;
    EXPECT_EQ(foreign.error.find("going on after"), std::string::npos);
}

TEST(PlanCommand, SaysWhatIsKeptAndLeftOut) {
    const TemporaryFolder folder;
    test::paintSmallWorld(folder / "capture", 5, 10, false);
    const test::ProgramResult words = relamp({"plan", folder / "capture", "--quality", "draft"}),
                              data = relamp({"plan", folder / "capture", "--quality", "draft", "--json"});
    ASSERT_EQ(words.exitCode, 0) << words.error;
    EXPECT_NE(words.out.find("left out"), std::string::npos) << words.out;
    ASSERT_EQ(data.exitCode, 0);
    const json plan = json::parse(data.out);
    for (const char* key : {"stages", "left_out", "predicted_s", "saved_s", "planning_s"})
        EXPECT_TRUE(plan.contains(key)) << key;
    const auto leavesOut = [&](const std::string& what) {
        return std::any_of(plan["left_out"].begin(), plan["left_out"].end(),
                           [&](const json& o) { return o["what"] == what && !o["reason"].get<std::string>().empty(); });
    };
    EXPECT_TRUE(leavesOut("near-field emitters"));
    EXPECT_EQ(fs::exists(folder / "capture.relamp"), false);
    const json everything =
        json::parse(relamp({"plan", folder / "capture", "--quality", "draft", "--json", "--everything"}).out);
    EXPECT_GE(plan["left_out"].size(), everything["left_out"].size() + 1);
    // A solve keeps both what was foreseen and what it took.
    ASSERT_EQ(relamp({"solve", folder / "capture", "-o", folder / "x.relamp", "--quality", "draft"}).exitCode, 0);
    const json kept = json::parse(relamp({"info", folder / "x.relamp", "--json"}).out)["plan"];
    size_t both = 0;
    for (const json& s : kept["stages"]) both += s["predicted_s"].is_number() && s["measured_s"].is_number();
    EXPECT_GE(both, 4u);
}

TEST(StressCommand, TellsEveryCaseAsTableAndAsJson) {
    const TemporaryFolder folder;
    test::paintKnownWorld(folder / "capture", true, 4, 8);
    const test::ProgramResult table = relamp({"stress", folder / "capture", "--only", "one view"});
    EXPECT_EQ(table.exitCode, 0) << table.error;
    EXPECT_NE(table.out.find("capture: one view"), std::string::npos) << table.out;
    EXPECT_NE(table.out.find("100 % finite"), std::string::npos) << table.out;
    const test::ProgramResult data = relamp({"stress", folder / "capture", "--only", "no light at all", "--json"});
    ASSERT_EQ(data.exitCode, 0) << data.error;
    const json report = json::parse(data.out);
    ASSERT_EQ(report["cases"].size(), 1u);
    EXPECT_EQ(report["cases"][0]["name"], "world: no light at all");
    EXPECT_EQ(relamp({"stress", folder / "absent"}).exitCode, 3);
    EXPECT_EQ(relamp({"stress"}).exitCode, 2);
}

}  // namespace
}  // namespace relamp
