// A session of the editor without a window, for the tests of ui/editor: opened, estimated and polled as the window
// does.
#pragma once
#include <gtest/gtest.h>

#include <chrono>
#include <functional>
#include <memory>
#include <thread>

#include "editor.h"
#include "support/estimates.h"
#include "support/known_world.h"
#include "support/temporary_folder.h"

namespace relamp::ui {

using test::TemporaryFolder;

/// One small capture for all tests.
inline const std::filesystem::path& captureFolder() {
    static const TemporaryFolder folder;
    static const bool painted = [] {
        relamp::test::paintSmallWorld(folder / "room");
        return true;
    }();
    static const std::filesystem::path path = folder / "room";
    EXPECT_TRUE(painted);
    return path;
}

struct Session {
    TemporaryFolder folder;
    std::unique_ptr<Editor> editor;
    explicit Session(double autosaveSeconds = 1000) { start(autosaveSeconds); }
    /// One that finds in its state folder what `killed` had put by.
    explicit Session(const std::filesystem::path& killed) {
        std::filesystem::create_directories(folder / "state");
        std::filesystem::copy(killed, folder / "state/estimates");
        start();
    }
    void start(double autosaveSeconds = 1000) {
        EditorOptions options;
        options.configFolder = folder / "config";
        options.stateFolder = folder / "state";
        options.autosaveSeconds = autosaveSeconds;
        options.checkpointSeconds = 1000;
        editor = std::make_unique<Editor>(options);
        editor->state.solve.quality = "draft";
    }
    /// Polls until `done`; fails after a minute.
    void until(const std::function<bool()>& done) {
#ifdef RELAMP_SANITIZED
        constexpr std::chrono::seconds patience(1200);
#else
        constexpr std::chrono::seconds patience(120);
#endif
        const auto start = std::chrono::steady_clock::now();
        while (!done()) {
            editor->poll();
            if (std::chrono::steady_clock::now() - start > patience) {
                ADD_FAILURE() << "waited too long" << (editor->job() ? " for " + editor->job()->title : "");
                return;
            }
            std::this_thread::sleep_for(std::chrono::milliseconds(2));
        }
    }
    void settle() {
        until([&] { return !editor->job() && !editor->busy(); });
    }
    void open(const std::filesystem::path& path) {
        editor->open(path);
        until([&] { return !editor->job(); });
    }
    void solve() {
        editor->solve(editor->state.solve);
        until([&] { return !editor->job(); });
    }
    /// A copy of a shot of that capture, for tests that need any estimate.
    inline void openEstimated();
};

/// The shot that `openEstimated` copies.
inline const std::filesystem::path& estimatedShot() {
    static const TemporaryFolder folder;
    static const std::filesystem::path shot = [] {
        Session s;
        s.open(captureFolder());
        s.solve();
        s.editor->saveAs(folder / "estimated.relamp");
        s.settle();
        return folder / "estimated.relamp";
    }();
    return shot;
}

void Session::openEstimated() {
    std::filesystem::copy(estimatedShot(), folder / "estimated.relamp", std::filesystem::copy_options::recursive);
    open(folder / "estimated.relamp");
}

inline Camera eyeAt(int width, int height) {
    return relamp::test::cameraAt({2, -1.5, 1.5}, {0, 0, 0.2}, width, height, width);
}

}  // namespace relamp::ui
