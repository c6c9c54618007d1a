// Programs killed without warning at random moments: what is on disk afterwards is whole, and opens. A few kills of
// each kind here; all of them with tests/kill/run.
#include <fcntl.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <random>

#include "gui/desktop.h"
#include "shot/checkpoint.h"
#include "shot/shot_file.h"
#include "support/known_world.h"
#include "support/run_program.h"

namespace relamp {
namespace {

namespace fs = std::filesystem;
using test::TemporaryFolder;
using Clock = std::chrono::steady_clock;

int numberFrom(const char* variable, int otherwise) {
    const char* text = std::getenv(variable);
    return text ? std::atoi(text) : otherwise;
}
int kills() { return numberFrom("RELAMP_KILLS", 3); }
unsigned seed() { return unsigned(numberFrom("RELAMP_KILL_SEED", 1)); }

/// Starts a program and kills it after `milliseconds`, counted from when `begun` holds; true when it was still running
/// then.
bool runAndKill(const std::vector<std::string>& arguments, int milliseconds, const std::function<bool()>& begun = {}) {
    std::vector<char*> words;
    for (const std::string& a : arguments) words.push_back(const_cast<char*>(a.c_str()));
    words.push_back(nullptr);
    const pid_t child = fork();
    if (child == 0) {
        const int nothing = open("/dev/null", O_RDWR);
        dup2(nothing, 0);
        dup2(nothing, 1);
        dup2(nothing, 2);
        execv(words[0], words.data());
        _exit(127);
    }
    for (int i = 0; begun && !begun() && i < 120'000 && kill(child, 0) == 0; ++i)
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    std::this_thread::sleep_for(std::chrono::milliseconds(milliseconds));
    kill(child, SIGKILL);
    int status = 0;
    waitpid(child, &status, 0);
    return WIFSIGNALED(status);
}

int millisecondsOf(const std::vector<std::string>& arguments) {
    const auto start = Clock::now();
    const test::ProgramResult result = test::runProgram(arguments);
    EXPECT_EQ(result.exitCode, 0) << result.error;
    return int(std::chrono::duration_cast<std::chrono::milliseconds>(Clock::now() - start).count());
}

/// A capture, and a shot of it: made once, each test has copies.
class KilledPrograms : public testing::Test {
protected:
    static void SetUpTestSuite() {
        made = new TemporaryFolder;
        test::paintSmallWorld(*made / "room");
        solveTime = millisecondsOf(
            {RELAMP_BINARY, "solve", *made / "room", "-o", *made / "room.relamp", "--quality", "draft", "--seed", "1"});
    }
    static void TearDownTestSuite() { delete made; }
    void SetUp() override {
        for (const char* name : {"room", "room.relamp"})
            fs::copy(*made / name, folder / name, fs::copy_options::recursive);
    }
    std::vector<std::string> solve(int number) const {
        return {RELAMP_BINARY, "solve", folder / "room", "-o",     shot(),
                "--quality",   "draft", "--overwrite",   "--seed", std::to_string(number)};
    }
    fs::path shot() const { return folder / "room.relamp"; }
    fs::path checkpoint() const { return checkpointFile(shot()); }
    Shot opened() const {
        Progress progress;
        return openShot(shot(), true, progress);
    }
    /// Entries of the folder that are neither the capture, the shot, the checkpoint to go on from nor a lock's file.
    std::vector<std::string> leftovers() const {
        std::vector<std::string> names;
        for (const auto& entry : fs::directory_iterator(folder.path()))
            if (const std::string name = entry.path().filename().string();
                name != "room" && name != "room.relamp" && entry.path() != checkpoint() && !name.ends_with(".lock"))
                names.push_back(name);
        return names;
    }
    static inline TemporaryFolder* made = nullptr;
    static inline int solveTime = 0;
    TemporaryFolder folder;
};

TEST_F(KilledPrograms, aSolveLeavesTheOldShotOrTheNewOne) {
    std::mt19937 random(seed());
    folder.write("room.relamp/notes.txt", "mine");
    int running = 0;
    for (int n = 0; n < kills(); ++n) {
        running += runAndKill(solve(n + 2), int(random() % unsigned(solveTime + solveTime / 10 + 1)));
        Shot shot;
        ASSERT_NO_THROW(shot = opened()) << "kill " << n;
        EXPECT_EQ(shot.estimate.emitters.emitters.size(), 1u);
        EXPECT_GE(shot.seed, 1u);
        EXPECT_LE(shot.seed, uint64_t(n) + 2);
        EXPECT_EQ(leftovers(), std::vector<std::string>{}) << "opening clears away what is not whole";
        ASSERT_TRUE(fs::exists(folder / "room.relamp/notes.txt"));
        if (!fs::exists(checkpoint())) continue;
        const std::string refused = readCheckpoint(checkpoint(), 0).refused;
        EXPECT_EQ(refused.find("damaged"), std::string::npos) << refused;
        EXPECT_NE(refused.find("belongs to another"), std::string::npos) << refused;
    }
    std::printf("kill: solve: %d kills, %d while it ran; every time the shot opened\n", kills(), running);
}

TEST_F(KilledPrograms, framesAreWholeOrNotThere) {
    std::mt19937 random(seed() + 1);
    const auto render = [&](const std::string& into) {
        return std::vector<std::string>{
            RELAMP_BINARY, "render",       shot(),   "-o",      folder / (into + "/f.##.exr"),
            "--camera",    "turntable:12", "--size", "160x120", "--samples",
            "1",           "--layers",     "all"};
    };
    fs::create_directories(folder / "reference");
    const int time = millisecondsOf(render("reference"));
    int running = 0;
    size_t frames = 0;
    for (int n = 0; n < kills(); ++n) {
        fs::remove_all(folder / "out");
        fs::create_directories(folder / "out");
        running += runAndKill(render("out"), int(random() % unsigned(time)));
        for (const auto& entry : fs::directory_iterator(folder / "out")) {
            const std::string name = entry.path().filename().string();
            if (name[0] == '.') continue;
            ++frames;
            EXPECT_EQ(TemporaryFolder::read(entry.path()), TemporaryFolder::read(folder / ("reference/" + name)))
                << "torn: " << name;
        }
    }
    std::printf(
        "kill: frames: %d kills, %d while it ran; %zu frames there, each byte for byte what an undisturbed run "
        "writes\n",
        kills(), running, frames);
}

TEST_F(KilledPrograms, exportedScenesAreMadeOfWholeFiles) {
    std::mt19937 random(seed() + 2);
    const auto exported = [&](const std::string& into) {
        return std::vector<std::string>{RELAMP_BINARY, "export", shot(), "-o", folder / into, "--overwrite"};
    };
    const int time = millisecondsOf(exported("reference"));
    int running = 0;
    size_t files = 0;
    for (int n = 0; n < kills(); ++n) {
        fs::remove_all(folder / "out");
        // Files come at the end: most kills fall there.
        running += runAndKill(exported("out"), time * 2 / 3 + int(random() % unsigned(time / 2)));
        if (!fs::exists(folder / "out")) continue;
        for (const auto& entry : fs::directory_iterator(folder / "out")) {
            const std::string name = entry.path().filename().string();
            if (name[0] == '.') continue;
            ++files;
            EXPECT_EQ(fs::file_size(entry.path()), fs::file_size(folder / ("reference/" + name))) << "torn: " << name;
        }
    }
    std::printf("kill: scene files: %d kills, %d while it ran; %zu files there, all whole\n", kills(), running, files);
}

/// What a session's journal says.
struct Journal {
    long opened = -1, last = 0, old = 0;  ///< old: the last edit made 30 s or more before the last entry
    double seconds = 0;
    std::vector<std::string> notices;
    explicit Journal(const std::string& text) {
        std::istringstream lines(text);
        std::vector<std::pair<double, long>> edits;
        for (std::string line; std::getline(lines, line);) {
            if (lines.eof()) break;  // cut off by the kill
            std::istringstream words(line);
            std::string what;
            words >> what;
            if (what == "opened") words >> opened, last = old = opened;
            if (what == "notice") notices.push_back(line);
            if (what != "edit") continue;
            words >> last >> seconds;
            edits.emplace_back(seconds, last);
        }
        for (const auto& [time, edit] : edits)
            if (time <= seconds - 30) old = edit;
    }
};

TEST_F(KilledPrograms, noEditOlderThanThirtySecondsIsLost) {
    std::mt19937 random(seed() + 3);
    long mustHave = 0, mayHave = 0, edits = 0;
    int returned = 0, notYet = 0;
    for (int n = 0; n <= kills(); ++n) {
        const fs::path journal = folder / "journal";
        fs::remove(journal);
        // One in three falls while it opens or restores, the others while it works.
        const auto works = [&] { return TemporaryFolder::read(journal).find("edit") != std::string::npos; };
        ASSERT_TRUE(runAndKill(
            {RELAMP_KILL_SESSION, shot(), folder / "home", journal, std::to_string(seed() * 1000 + unsigned(n))},
            int(random() % (n % 3 == 1 ? 300 : 1500)), n % 3 == 1 ? std::function<bool()>() : works))
            << "the session ended by itself";
        Progress progress;
        ASSERT_NO_THROW(openShot(shot(), false, progress)) << "kill " << n;
        const Journal said(TemporaryFolder::read(journal));
        for (const std::string& notice : said.notices) ADD_FAILURE() << notice;
        if (said.opened < 0) {
            ++notYet;  // killed while it opened: the next session has to come back with the same
            continue;
        }
        ++returned;
        EXPECT_GE(said.opened, mustHave) << "kill " << n << ": edits that were older than 30 s are lost";
        EXPECT_LE(said.opened, mayHave) << "kill " << n;
        mustHave = said.old;
        mayHave = said.last + 1;  // made, but killed before it was in the journal
        edits += said.last - said.opened;
    }
    EXPECT_GT(edits, 0);
    std::printf(
        "kill: editor: %d kills, %d while it was opening or restoring; %ld edits, none lost that was older than 30 s\n",
        kills() + 1, notYet, edits);
}

/// The real window, killed while the mouse drags; a minute each, so it is left to tests/kill/run.
TEST(KilledWindow, DISABLED_comesBackWithEverythingOlderThanThirtySeconds) {
    std::mt19937 random(seed() + 4);
    const TemporaryFolder folder;
    test::paintSmallWorld(folder / "room");
    test::Desktop desk(1024, 640);
    const std::vector<std::string> size{"--width", "1024", "--height", "640"};
    const auto with = [&](std::vector<std::string> more) {
        more.insert(more.end(), size.begin(), size.end());
        return more;
    };
    desk.start(with({"--solve", "--quality", "draft", folder / "room"}));
    ASSERT_TRUE(desk.until([](const nlohmann::json& m) { return m["estimate"] == true && m["job"] == ""; }, 100));
    ASSERT_TRUE(desk.settled());
    const auto movedBy = [&] {
        for (const auto& entry : fs::recursive_directory_iterator(desk.home() / "state"))
            if (entry.path().string().ends_with(".autosave.json"))
                return nlohmann::json::parse(TemporaryFolder::read(entry.path()))["look"]
                    .value("emitters", nlohmann::json::array())
                    .dump();
        return std::string();
    };
    const int rounds = std::max(1, kills() / 10);
    for (int n = 0; n < rounds; ++n) {
        // An edit, then a drag that goes on for longer than autosaving waits.
        desk.moveTo(512, 250);
        desk.key("ctrl+a");
        desk.key("g");
        desk.type("z0.0" + std::to_string(n + 1));
        desk.key("Return");
        const std::string label = desk.map()["label"];
        EXPECT_NE(label.find("Move"), std::string::npos) << label;
        const auto edited = Clock::now();
        desk.key("g");
        while (Clock::now() - edited < std::chrono::seconds(30) + std::chrono::milliseconds(random() % 5000)) {
            desk.moveTo(450 + int(random() % 100), 230 + int(random() % 60));
            std::this_thread::sleep_for(std::chrono::milliseconds(50));
        }
        desk.end(SIGKILL);
        const std::string kept = movedBy();
        ASSERT_FALSE(kept.empty()) << "nothing was kept";
        desk.start(size);
        ASSERT_TRUE(desk.until([](const nlohmann::json& m) { return m["recovery"] == true; }, 60));
        desk.click("Restore");
        ASSERT_TRUE(desk.until([](const nlohmann::json& m) { return m["estimate"] == true && m["job"] == ""; }, 100));
        EXPECT_EQ(desk.map()["label"], "Recovered work");
        ASSERT_TRUE(desk.settled());
        EXPECT_NE(kept.find("matrix"), std::string::npos) << kept;
    }
    std::printf("kill: window: %d kills in the middle of a drag; the edit before it and the drag itself came back\n",
                rounds);
}

}  // namespace
}  // namespace relamp
