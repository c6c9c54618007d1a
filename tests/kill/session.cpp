// An editor without a window that works until it is killed: edits, drags and saves, by a clock of its own that runs
// faster than ours. It says in a journal what it did and when, so that the next session can be held against it.
//
//   relamp_kill_session SHOT HOME JOURNAL SEED
//
// Journal lines: "opened N" (the edit the work came back with), "edit N SECONDS", "notice TEXT". Edit N turns the
// environment to N degrees.
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <fstream>
#include <random>
#include <thread>

#include "editor.h"

namespace {

using namespace relamp;

int run(const std::filesystem::path& shot, const std::filesystem::path& home, const std::string& journalFile,
        unsigned seed) {
    std::mt19937 random(seed);
    const auto chance = [&](double fraction) { return std::uniform_real_distribution<>(0, 1)(random) < fraction; };
    double clock = 1000;
    std::FILE* journal = std::fopen(journalFile.c_str(), "a");
    if (!journal) return 1;
    const auto write = [&](const std::string& line) {
        std::fputs((line + "\n").c_str(), journal);
        std::fflush(journal);
    };
    ui::EditorOptions options;
    options.configFolder = home / "config";
    options.stateFolder = home / "state";
    options.gpu = ui::EditorOptions::Gpu::off;
    options.seconds = [&clock] { return clock; };
    ui::Editor editor(options);
    const auto notices = [&] {
        for (const ui::Notice& notice : editor.state.notices) write("notice " + notice.title + ": " + notice.text);
        editor.state.notices.clear();
    };
    if (editor.state.recovery) editor.answerRecovery(true);
    else editor.openNow(shot);
    while (editor.job()) {
        editor.poll();
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    notices();
    if (!editor.estimate()) return 1;
    long count = std::lround(editor.look().environment.yawDegrees);
    write(fmt::format("opened {}", count));
    const auto turn = [&](float degrees) { return [degrees](Look& look) { look.environment.yawDegrees = degrees; }; };
    const auto pass = [&](int seconds) {
        for (int i = 0; i < seconds; ++i) {
            clock += 1;
            editor.poll();
            std::this_thread::sleep_for(std::chrono::microseconds(300));
        }
    };
    for (;;) {
        if (chance(0.7)) {
            editor.edit("Turn", turn(float(++count)));
        } else {
            // A drag, now and then longer than autosaving waits.
            editor.beginGesture("Turn");
            const int moves = chance(0.2) ? 50 : 5;
            for (int i = 0; i < moves; ++i) {
                editor.preview(turn(float(count) + 0.9f * float(i) / float(moves)));
                pass(1);
            }
            editor.preview(turn(float(++count)));
            editor.commitGesture();
        }
        write(fmt::format("edit {} {}", count, clock));
        if (chance(0.1)) editor.undo(), editor.redo();
        if (chance(0.15)) editor.save();
        pass(1 + int(random() % 6));
        notices();
    }
}

}  // namespace

int main(int argc, char** argv) {
    if (argc != 5) return 2;
    try {
        return run(argv[1], argv[2], argv[3], unsigned(std::stoul(argv[4])));
    } catch (const std::exception& error) {
        std::fprintf(stderr, "%s\n", error.what());
        return 1;
    }
}
