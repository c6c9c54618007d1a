// The editor without a window: documents, background work, undo, autosave, export.
#include "editor.h"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>
#include <unistd.h>

#include <chrono>
#include <thread>

#include "actions.h"
#include "image/image_io.h"
#include "support/estimates.h"
#include "support/known_world.h"
#include "support/temporary_folder.h"

namespace relamp::ui {
namespace {

using test::TemporaryFolder;

/// One small capture for all tests of this file.
const std::filesystem::path& captureFolder() {
    static const TemporaryFolder folder;
    static const bool painted = [] {
        test::paintKnownWorld(folder / "room", true, 6, 10);
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
        options.checkpointSeconds = 0;
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
};

Camera eyeAt(int width, int height) { return test::cameraAt({2, -1.5, 1.5}, {0, 0, 0.2}, width, height, width); }

TEST(Editor, opensEstimatesAndShowsTheScene) {
    Session s;
    s.open(captureFolder());
    ASSERT_TRUE(s.editor->state.document.capture);
    EXPECT_TRUE(s.editor->state.notices.empty()) << s.editor->state.notices[0].text;
    EXPECT_EQ(s.editor->state.document.name(), "room");
    EXPECT_FALSE(s.editor->estimate());
    s.editor->setEye(eyeAt(80, 60), false);
    bool shownEarly = false;
    s.editor->solve(s.editor->state.solve);
    s.until([&] {
        // Intermediate results before the end, without an entry in the history.
        shownEarly = shownEarly || (s.editor->job() && s.editor->estimate() && !s.editor->history().present().estimate);
        return !s.editor->job();
    });
    EXPECT_TRUE(shownEarly);
    ASSERT_TRUE(s.editor->estimate());
    EXPECT_EQ(s.editor->emitters().size(), 1u);
    EXPECT_EQ(s.editor->history().entries().size(), 2u);
    EXPECT_GT(s.editor->state.curves[0].entries.size(), 3u);
    EXPECT_FALSE(s.editor->state.curves[0].running);
    EXPECT_FALSE(s.editor->stale());
    s.editor->state.solve.quality = "fine";
    EXPECT_TRUE(s.editor->stale());
    s.settle();
    ASSERT_TRUE(s.editor->liveFrame());
    EXPECT_TRUE(s.editor->liveFrame()->refined);
    ASSERT_TRUE(s.editor->restFrame());
    EXPECT_EQ(s.editor->restFrame()->width, 80);
    s.editor->undo();
    EXPECT_FALSE(s.editor->estimate());
}

TEST(Editor, aCancelledSolveKeepsTheBestSoFar) {
    Session s;
    s.open(captureFolder());
    s.editor->solve(s.editor->state.solve);
    s.until([&] { return s.editor->estimate() || !s.editor->job(); });
    ASSERT_TRUE(s.editor->job());
    s.editor->cancelJob();
    EXPECT_TRUE(s.editor->job()->stopping);
    s.until([&] { return !s.editor->job(); });
    ASSERT_TRUE(s.editor->history().present().estimate);
    EXPECT_TRUE(s.editor->estimate()->cancelled);
    EXPECT_EQ(s.editor->history().entries().back().label, "Estimate, stopped early");
    // And one that is stopped before there is anything leaves everything as it was.
    Session early;
    early.open(captureFolder());
    early.editor->solve(early.editor->state.solve);
    early.editor->cancelJob();
    early.until([&] { return !early.editor->job(); });
    EXPECT_FALSE(early.editor->estimate());
    EXPECT_EQ(early.editor->history().entries().size(), 1u);
    EXPECT_TRUE(early.editor->state.notices.empty());
}

bool hasFiles(const std::filesystem::path& folder) {
    std::error_code none;
    return std::filesystem::directory_iterator(folder, none) != std::filesystem::directory_iterator();
}

/// Estimates until something is shown and a checkpoint is there.
void solveUntilKept(Session& s) {
    s.editor->solve(s.editor->state.solve);
    s.until([&] {
        std::error_code none;
        for (const auto& entry : std::filesystem::directory_iterator(s.folder / "state/estimates", none))
            if (entry.path().extension() == ".checkpoint" && s.editor->estimate()) return true;
        return !s.editor->job();
    });
    ASSERT_TRUE(s.editor->job()) << "it ended before it could be stopped";
}

/// What an estimate is saved as by itself when it is killed: copied while it runs, once it has got anywhere.
void copyOfAKilledEstimate(Session& s, const std::filesystem::path& to) {
    const std::filesystem::path kept = s.folder / "state/estimates";
    solveUntilKept(s);
    std::filesystem::create_directories(to);
    for (const auto& entry : std::filesystem::directory_iterator(kept))
        if (!entry.path().filename().string().starts_with(".")) std::filesystem::copy(entry.path(), to);
}

void expectSameAnswer(const Estimate& a, const Estimate& b) {
    EXPECT_EQ(a.environment, b.environment);
    EXPECT_EQ(a.lighting.emitterRadiance, b.lighting.emitterRadiance);
    EXPECT_EQ(a.reflectance.weight, b.reflectance.weight);
}

TEST(Editor, aKilledEstimateIsOfferedAndEndsInTheSameAnswer) {
    Session whole;
    TemporaryFolder killed;
    whole.open(captureFolder());
    whole.editor->state.solve.seed = 7;
    copyOfAKilledEstimate(whole, killed / "estimates");
    whole.until([&] { return !whole.editor->job(); });
    ASSERT_TRUE(whole.editor->history().present().estimate);
    EXPECT_FALSE(whole.editor->state.interrupted) << "it came to its end";
    EXPECT_FALSE(hasFiles(whole.folder / "state/estimates"));

    // The program starts again: the offer opens the capture, and the settings are those of the estimate.
    Session next(killed / "estimates");
    ASSERT_TRUE(next.editor->state.interrupted);
    EXPECT_EQ(next.editor->state.interrupted->captureFolder, captureFolder());
    next.editor->answerInterrupted(true);
    next.until([&] { return next.editor->history().present().estimate || !next.editor->state.notices.empty(); });
    ASSERT_TRUE(next.editor->history().present().estimate);
    EXPECT_EQ(next.editor->state.solve.seed, 7u);
    EXPECT_EQ(next.editor->state.document.seed, 7u);
    expectSameAnswer(*next.editor->estimate(), *whole.editor->estimate());
    EXPECT_GT(next.editor->state.curves[0].entries.size(), 3u);
    EXPECT_FALSE(hasFiles(next.folder / "state/estimates"));

    // So does the capture when it is opened by hand.
    Session byHand(killed / "estimates");
    byHand.open(captureFolder());
    ASSERT_TRUE(byHand.editor->state.interrupted);
    EXPECT_GT(byHand.editor->state.interrupted->seconds, 0);
    byHand.editor->answerInterrupted(true);
    byHand.until([&] { return !byHand.editor->job(); });
    ASSERT_TRUE(byHand.editor->history().present().estimate);
    expectSameAnswer(*byHand.editor->estimate(), *whole.editor->estimate());
}

TEST(Editor, aStoppedEstimateCanGoOn) {
    Session s;
    s.open(captureFolder());
    solveUntilKept(s);
    s.editor->cancelJob();
    s.until([&] { return !s.editor->job(); });
    ASSERT_TRUE(s.editor->state.interrupted);
    EXPECT_TRUE(s.editor->estimate()->cancelled);
    s.editor->answerInterrupted(true);
    EXPECT_FALSE(s.editor->state.interrupted) << "nothing is offered while it runs";
    s.until([&] { return !s.editor->job(); });
    EXPECT_FALSE(s.editor->estimate()->cancelled);
    EXPECT_FALSE(s.editor->state.interrupted);
}

TEST(Editor, anInterruptedEstimateIsRefusedForOtherInputsAndCanBeThrownAway) {
    TemporaryFolder killed;
    {
        Session s;
        s.open(captureFolder());
        copyOfAKilledEstimate(s, killed / "estimates");
    }
    // Another capture behind the same name: the record is there, its checkpoint does not fit.
    Session changed(killed / "estimates");
    for (const auto& entry : std::filesystem::directory_iterator(changed.folder / "state/estimates")) {
        if (!entry.path().string().ends_with(".json")) continue;
        std::string text = TemporaryFolder::read(entry.path());
        const size_t at = text.find("\"seed\": 1");
        ASSERT_NE(at, std::string::npos);
        changed.folder.write("state/estimates/" + entry.path().filename().string(), text.replace(at, 9, "\"seed\": 2"));
    }
    changed.open(captureFolder());
    EXPECT_FALSE(changed.editor->state.interrupted);

    Session damaged(killed / "estimates");
    for (const auto& entry : std::filesystem::directory_iterator(damaged.folder / "state/estimates"))
        damaged.folder.write("state/estimates/" + entry.path().filename().string(), "{");
    damaged.open(captureFolder());
    EXPECT_FALSE(damaged.editor->state.interrupted);

    Session thrownAway(killed / "estimates");
    thrownAway.open(captureFolder());
    ASSERT_TRUE(thrownAway.editor->state.interrupted);
    thrownAway.editor->answerInterrupted(false);
    EXPECT_FALSE(thrownAway.editor->state.interrupted);
    EXPECT_FALSE(hasFiles(thrownAway.folder / "state/estimates"));
}

TEST(Editor, timeLeftComesFromThePlan) {
    Session s;
    s.open(captureFolder());
    s.editor->solve(s.editor->state.solve);
    bool told = false;
    s.until([&] {
        const auto& job = s.editor->job();
        if (job && !s.editor->state.plan.stages.empty() && job->secondsLeft) {
            told = true;
            EXPECT_LE(*job->secondsLeft, 4 * s.editor->state.plan.predictedSeconds() + 0.1);
        }
        return !job;
    });
    EXPECT_TRUE(told);
}

TEST(Editor, advancedSettingsOfTheEstimateTakePartAndAreRemembered) {
    Session s;
    s.editor->state.solve.basis = "lambert";
    s.editor->state.solve.bounce = SolveOptions::Bounce::off;
    s.editor->state.solve.meshTriangles = 500;
    s.open(captureFolder());
    s.solve();
    ASSERT_TRUE(s.editor->estimate());
    const Estimate& e = *s.editor->estimate();
    EXPECT_EQ(e.reflectance.basis.lobes.size(), 1u);
    EXPECT_EQ(e.reflectance.weight[0].size(), s.editor->state.document.scene->mesh.vertexCount());
    const auto leftOut = [&](Omission what) {
        return std::any_of(e.leftOut.begin(), e.leftOut.end(), [&](const LeftOut& l) { return l.what == what; });
    };
    EXPECT_TRUE(leftOut(Omission::triangles));
    EXPECT_TRUE(leftOut(Omission::interreflection));
    EXPECT_FALSE(s.editor->stale());
    s.editor->state.solve.meshTriangles.reset();
    EXPECT_TRUE(s.editor->stale());
    s.editor->state.solve.merl = "/nowhere";
    s.solve();
    ASSERT_EQ(s.editor->state.notices.size(), 1u);
    EXPECT_NE(s.editor->state.notices[0].text.find("/nowhere"), std::string::npos);
    s.editor.reset();
    s.start();
    EXPECT_EQ(s.editor->state.solve.basis, "lambert");
    EXPECT_EQ(s.editor->state.solve.bounce, SolveOptions::Bounce::off);
    EXPECT_EQ(s.editor->state.solve.merl, "/nowhere");
    EXPECT_FALSE(s.editor->state.solve.meshTriangles);
}

TEST(Editor, aSearchForAnUnobservedEmitterCanBeStoppedAndAnEmitterTakenAwayAgain) {
    Session s;
    s.open(captureFolder());
    const size_t vertices = s.editor->state.document.scene->mesh.vertexCount();
    s.editor->findUnobservedLight();
    ASSERT_TRUE(s.editor->job());
    EXPECT_EQ(s.editor->job()->kind, JobStatus::Kind::search);
    s.editor->cancelJob();
    s.until([&] { return !s.editor->job(); });
    EXPECT_TRUE(s.editor->state.notices.empty());
    EXPECT_TRUE(s.editor->state.unobservedSearch.words.empty());
    EXPECT_EQ(s.editor->state.document.scene->mesh.vertexCount(), vertices);
    CaptureFix fix = s.editor->state.document.fix;
    fix.proxies.push_back({{0.4f, 0.2f, 1.1f}, 0.02f, Vec3(0), false});
    s.editor->fixCapture(fix);
    s.until([&] { return !s.editor->job(); });
    EXPECT_EQ(s.editor->state.document.scene->mesh.vertexCount(), vertices + proxyVertices);
    s.editor->removeProxy(1);
    EXPECT_FALSE(s.editor->job());
    s.editor->removeProxy(0);
    s.until([&] { return !s.editor->job(); });
    EXPECT_EQ(s.editor->state.document.scene->mesh.vertexCount(), vertices);
    EXPECT_TRUE(s.editor->state.document.fix.proxies.empty());
}

TEST(Editor, savesOpensAgainAndKnowsWhatIsUnsaved) {
    Session s;
    s.open(captureFolder());
    s.solve();
    EXPECT_TRUE(s.editor->unsavedChanges());
    s.editor->edit("Turn", [](Look& look) { look.environment.yawDegrees = 40; });
    s.editor->saveAs(s.folder / "first");
    s.settle();
    EXPECT_TRUE(s.editor->state.notices.empty());
    EXPECT_FALSE(s.editor->unsavedChanges());
    EXPECT_TRUE(std::filesystem::exists(s.folder / "first.relamp/shot.json"));
    s.editor->edit("Turn", [](Look& look) { look.environment.yawDegrees = 50; });
    EXPECT_TRUE(s.editor->unsavedChanges());
    // Opening something else asks first.
    s.editor->open(s.folder / "first.relamp");
    ASSERT_TRUE(s.editor->state.unsaved);
    EXPECT_FALSE(s.editor->job());
    s.editor->answerUnsaved(true, true);
    s.until([&] { return s.editor->look().environment.yawDegrees == 50 && s.editor->history().entries().size() == 1; });
    EXPECT_FALSE(s.editor->unsavedChanges());
    EXPECT_EQ(s.editor->emitters().size(), 1u);
}

TEST(Editor, anUnsavedEditSurvivesAKilledProcess) {
    Session s(0);
    s.open(captureFolder());
    s.solve();
    s.until([&] { return !s.editor->busy(); });  // the estimate is put away as well
    s.editor->edit("Turn", [](Look& look) { look.environment.yawDegrees = 30; });
    s.editor->edit("Brighter", [](Look& look) { look.environment.exposureStops = 2; });
    s.until([&] {
        for (const auto& entry : std::filesystem::directory_iterator(s.folder / "state"))
            if (entry.path().string().ends_with(".autosave.json") &&
                TemporaryFolder::read(entry.path()).find("\"exposure_stops\": 2") != std::string::npos)
                return true;
        return false;
    });
    s.editor.reset();  // without quitting: as if killed, the autosave stays
    s.start();
    ASSERT_TRUE(s.editor->state.recovery);
    EXPECT_EQ(s.editor->state.recovery->project, captureFolder().string());
    s.editor->answerRecovery(true);
    s.until([&] { return !s.editor->job(); });
    ASSERT_TRUE(s.editor->estimate());
    EXPECT_EQ(s.editor->look().environment.exposureStops, 2);
    EXPECT_TRUE(s.editor->unsavedChanges());
    EXPECT_TRUE(s.editor->state.document.shotFolder.empty());
    // What led there can be undone, one step after the other.
    s.editor->undo();
    EXPECT_EQ(s.editor->look().environment.exposureStops, 0);
    EXPECT_EQ(s.editor->look().environment.yawDegrees, 30);
    s.editor->undo();
    EXPECT_EQ(s.editor->look().environment.yawDegrees, 0);
    EXPECT_TRUE(s.editor->estimate());
    s.editor->redo();
    s.editor->redo();
    EXPECT_EQ(s.editor->look().environment.exposureStops, 2);
    s.settle();
    // Given up on quitting, nothing is offered again.
    s.editor->requestQuit();
    ASSERT_TRUE(s.editor->state.unsaved);
    s.editor->answerUnsaved(false, true);
    EXPECT_TRUE(s.editor->quitting());
    s.start();
    EXPECT_FALSE(s.editor->state.recovery);
}

TEST(Editor, badThingsEndInANoticeAndLeaveTheDocumentAlone) {
    Session s;
    s.open(captureFolder());
    s.solve();
    const auto refused = [&](const std::filesystem::path& path) {
        s.editor->openNow(path);
        s.until([&] { return !s.editor->job(); });
        const bool told = !s.editor->state.notices.empty();
        const std::string text = told ? s.editor->state.notices.back().text : "";
        s.editor->state.notices.clear();
        EXPECT_TRUE(told) << path;
        EXPECT_TRUE(s.editor->estimate()) << path;
        return text;
    };
    EXPECT_NE(refused(s.folder / "nowhere").find("does not exist"), std::string::npos);
    // What cannot even be looked at: a circle of links, a name longer than any may be.
    std::filesystem::create_symlink("circle", s.folder / "circle");
    EXPECT_NE(refused(s.folder / "circle").find("does not exist"), std::string::npos);
    EXPECT_NE(refused(s.folder / std::string(300, 'x')).find("does not exist"), std::string::npos);
    EXPECT_NE(refused({}).find("does not exist"), std::string::npos);
    s.folder.write("broken/transforms.json", "{\"frames\": 3}");
    EXPECT_NE(refused(s.folder / "broken").find("frames"), std::string::npos);
    s.folder.write("newer.relamp/shot.json", "{\"version\": 9}");
    EXPECT_NE(refused(s.folder / "newer.relamp").find("version"), std::string::npos);
    // No image at all as environment: the edit stays, the notice says why it does not show.
    s.folder.write("fake.exr", "no image");
    s.editor->setEye(eyeAt(40, 30), false);
    s.editor->open(s.folder / "fake.exr");
    s.until([&] { return !s.editor->state.notices.empty(); });
    EXPECT_NE(s.editor->state.notices[0].text.find("fake.exr"), std::string::npos);
    s.editor->state.notices.clear();
    s.editor->undo();
    s.settle();
    EXPECT_TRUE(s.editor->liveFrame());
    // A place that cannot be written.
    s.folder.write("file", "");
    s.editor->saveAs(s.folder / "file/shot");
    s.until([&] { return !s.editor->state.notices.empty(); });
    EXPECT_TRUE(s.editor->unsavedChanges());
}

TEST(Editor, aSecondEditorIsToldAndCannotOverwriteTheFirst) {
    Session first, second;
    first.open(captureFolder());
    first.solve();
    first.editor->saveAs(first.folder / "shared");
    first.settle();
    const std::filesystem::path shot = first.folder / "shared.relamp";
    ASSERT_TRUE(first.editor->state.notices.empty());

    second.editor->openNow(shot);
    ASSERT_TRUE(second.editor->state.locked);
    EXPECT_NE(second.editor->state.locked->owner.find("process " + std::to_string(getpid())), std::string::npos);
    EXPECT_FALSE(second.editor->job());
    second.editor->answerLocked(LockedAnswer::cancel);
    EXPECT_FALSE(second.editor->job());
    EXPECT_FALSE(second.editor->state.document.capture);

    // Read-only: edits can be tried, saving asks for another place, and the first one's shot stays as it is.
    second.editor->openNow(shot);
    second.editor->answerLocked(LockedAnswer::readOnly);
    second.until([&] { return !second.editor->job(); });
    ASSERT_TRUE(second.editor->estimate());
    EXPECT_TRUE(second.editor->state.document.readOnly);
    second.editor->edit("Turn", [](Look& look) { look.environment.yawDegrees = 77; });
    second.editor->save();
    EXPECT_TRUE(std::exchange(second.editor->state.panels.saveBrowser, false));
    second.editor->saveAs(shot);
    ASSERT_EQ(second.editor->state.notices.size(), 1u);
    EXPECT_NE(second.editor->state.notices[0].text.find("shared.relamp is open"), std::string::npos);
    EXPECT_TRUE(second.editor->unsavedChanges());
    EXPECT_EQ(TemporaryFolder::read(shot / "shot.json").find("\"yaw_degrees\": 77"), std::string::npos);
    second.editor->saveAs(second.folder / "mine");
    second.settle();
    EXPECT_FALSE(second.editor->unsavedChanges());
    EXPECT_FALSE(second.editor->state.document.readOnly);

    // A copy is the second one's own.
    second.editor->openNow(shot);
    second.editor->answerLocked(LockedAnswer::copy);
    second.until([&] { return !second.editor->job(); });
    EXPECT_EQ(second.editor->state.document.shotFolder, first.folder / "shared-copy.relamp");
    EXPECT_FALSE(second.editor->state.document.readOnly);
    second.editor->edit("Turn", [](Look& look) { look.environment.yawDegrees = 78; });
    second.editor->save();
    second.settle();
    EXPECT_FALSE(second.editor->unsavedChanges());

    // Closed by the first, it is free again.
    first.editor.reset();
    second.editor->openNow(shot);
    EXPECT_FALSE(second.editor->state.locked);
    second.until([&] { return !second.editor->job(); });
    EXPECT_EQ(second.editor->state.document.shotFolder, shot);
    EXPECT_FALSE(second.editor->state.document.readOnly);
}

TEST(Editor, aFullDiskIsToldOnceAndAutosavingGoesOnWhenThereIsRoom) {
    Session s;
    double now = 0;
    s.editor.reset();
    EditorOptions options;
    options.configFolder = s.folder / "config";
    options.stateFolder = s.folder / "state";
    options.seconds = [&now] { return now; };
    s.editor = std::make_unique<Editor>(options);
    s.editor->state.solve.quality = "draft";
    s.open(captureFolder());
    s.solve();
    s.settle();
    signal(SIGXFSZ, SIG_IGN);
    rlimit before{};
    getrlimit(RLIMIT_FSIZE, &before);
    const rlimit none{0, before.rlim_max};
    setrlimit(RLIMIT_FSIZE, &none);
    for (int i = 0; i < 3; ++i) {
        s.editor->edit("Turn", [&](Look& look) { look.environment.yawDegrees = 41 + float(i); });
        now += 20;
        s.editor->poll();
        s.settle();
    }
    setrlimit(RLIMIT_FSIZE, &before);
    ASSERT_EQ(s.editor->state.notices.size(), 1u);
    EXPECT_NE(s.editor->state.notices[0].text.find(".autosave.json"), std::string::npos)
        << s.editor->state.notices[0].text;
    now += 20;
    s.editor->poll();
    s.editor.reset();
    s.start();
    ASSERT_TRUE(s.editor->state.recovery);
    s.editor->answerRecovery(true);
    s.until([&] { return !s.editor->job(); });
    EXPECT_EQ(s.editor->look().environment.yawDegrees, 43);
}

TEST(Editor, editsAfterAnUndoneEstimateComeBackWithTheEstimateTheyWereMadeOn) {
    Session s(0);
    s.open(captureFolder());
    s.solve();
    s.settle();
    const auto first = s.editor->estimate();
    s.editor->state.solve.seed = 9;
    s.editor->state.solve.quality = "standard";
    s.solve();
    s.settle();
    ASSERT_NE(s.editor->estimate(), first);
    s.editor->undo();
    s.editor->edit("Turn", [](Look& look) { look.environment.yawDegrees = 12; });
    s.editor->poll();
    s.settle();
    s.editor->poll();
    s.editor.reset();
    s.start();
    ASSERT_TRUE(s.editor->state.recovery);
    s.editor->answerRecovery(true);
    s.until([&] { return !s.editor->job(); });
    EXPECT_EQ(s.editor->look().environment.yawDegrees, 12);
    ASSERT_TRUE(s.editor->estimate());
    EXPECT_EQ(s.editor->estimate()->timeline.size(), first->timeline.size());
    EXPECT_EQ(s.editor->estimate()->lighting.emitterRadiance, first->lighting.emitterRadiance);
}

TEST(Editor, photographsThatGoAwayTakeNothingWithThem) {
    Session s;
    test::paintKnownWorld(s.folder / "room", true, 6, 10);
    s.open(s.folder / "room");
    std::filesystem::rename(s.folder / "room/images", s.folder / "unplugged");
    // What is open needs them no more.
    s.solve();
    ASSERT_TRUE(s.editor->estimate());
    s.editor->edit("Turn", [](Look& look) { look.environment.yawDegrees = 5; });
    s.editor->saveAs(s.folder / "shot");
    s.settle();
    EXPECT_TRUE(s.editor->state.notices.empty());
    // Opened again it can be relit; estimating asks for them.
    s.open(s.folder / "shot.relamp");
    ASSERT_TRUE(s.editor->estimate());
    EXPECT_EQ(s.editor->look().environment.yawDegrees, 5);
    ASSERT_EQ(s.editor->state.notices.size(), 1u);
    EXPECT_NE(s.editor->state.notices[0].text.find("images/"), std::string::npos) << s.editor->state.notices[0].text;
    s.editor->state.notices.clear();
    s.editor->solve(s.editor->state.solve);
    EXPECT_FALSE(s.editor->job());
    EXPECT_EQ(s.editor->state.notices.size(), 1u);
    // The mesh as well: a sentence, and what was open stays.
    std::filesystem::rename(s.folder / "room", s.folder / "unplugged-too");
    s.editor->state.notices.clear();
    s.open(s.folder / "shot.relamp");
    ASSERT_EQ(s.editor->state.notices.size(), 1u);
    EXPECT_NE(s.editor->state.notices[0].text.find("room"), std::string::npos);
    EXPECT_TRUE(s.editor->estimate());
}

TEST(Editor, theViewportFollowsEditsAndSolo) {
    Session s;
    s.open(captureFolder());
    s.solve();
    s.editor->setEye(eyeAt(40, 30), false);
    s.settle();
    const auto brightness = [&] {
        double sum = 0;
        for (const Rgb& c : s.editor->liveFrame()->radiance) sum += luminance(c);
        return sum;
    };
    const double before = brightness();
    s.editor->state.selection.emitters = {"emitter-1"};
    EXPECT_TRUE(runAction(*s.editor, "light.mute"));
    s.editor->poll();
    s.settle();
    const double off = brightness();
    EXPECT_LT(off, 0.9 * before);
    s.editor->undo();
    s.editor->poll();
    s.settle();
    EXPECT_NEAR(brightness(), before, 1e-3 * before);
    // Where a point's light comes from.
    PickedPoint point;
    point.triangle = 0;
    point.barycentric = Vec2(0.3f);
    s.editor->pick(point);
    s.until([&] { return s.editor->state.pointLight.has_value(); });
    EXPECT_EQ(s.editor->state.pointLight->fromEmitter.size(), 1u);
    EXPECT_GT(
        luminance(s.editor->state.pointLight->fromEmitter[0]) + luminance(s.editor->state.pointLight->fromEnvironment),
        0);
}

TEST(Editor, exportsWhatTheCommandLineWouldRender) {
    Session s;
    s.open(captureFolder());
    s.solve();
    s.editor->edit("Move", [](Look& look) { moveEmitter(look, "emitter-1", test::translation({0.2f, 0, 0})); });
    ExportRequest request;
    request.views = ExportRequest::Views::capture;
    request.file = s.folder / "frame.exr";
    s.editor->exportFrames(request);
    s.until([&] { return !s.editor->job(); });
    ASSERT_TRUE(s.editor->state.notices.empty()) << s.editor->state.notices[0].text;
    Progress progress;
    const RelitScene relit =
        applyLook(*s.editor->state.document.scene, *s.editor->estimate(), s.editor->look(), progress);
    const Frame frame = renderFrame(relit, s.editor->state.document.capture->views[0].camera, {}, progress);
    const Image written = readImage(s.folder / "frame.exr");
    ASSERT_EQ(written.pixels.size(), frame.beauty.size());
    for (size_t i = 0; i < frame.beauty.size(); i += 17)
        EXPECT_NEAR(written.pixels[i].x, frame.beauty[i].x, 2e-3f * frame.beauty[i].x + 1e-6f);
    // Bad names are told before anything runs.
    request.views = ExportRequest::Views::all;
    s.editor->exportFrames(request);
    EXPECT_FALSE(s.editor->job());
    EXPECT_FALSE(s.editor->state.notices.empty());
}

TEST(Editor, aGestureIsOneEntryAndActionsHaveDistinctKeys) {
    Session s;
    s.open(captureFolder());
    s.solve();
    const size_t entries = s.editor->history().entries().size();
    s.editor->beginGesture("Turn the environment");
    for (int i = 0; i < 20; ++i) s.editor->preview([&](Look& look) { look.environment.yawDegrees += float(i); });
    EXPECT_EQ(s.editor->look().environment.yawDegrees, 19);
    s.editor->commitGesture();
    EXPECT_EQ(s.editor->history().entries().size(), entries + 1);
    std::vector<KeyChord> chords;
    for (const Action& a : actions()) {
        EXPECT_FALSE(a.label.empty() || a.explanation.empty()) << a.id;
        EXPECT_EQ(findAction(a.id), &a) << a.id;
        for (const KeyChord& chord : a.keys) {
            EXPECT_EQ(std::find(chords.begin(), chords.end(), chord), chords.end()) << a.id << ' ' << chord.text();
            chords.push_back(chord);
        }
    }
}

}  // namespace
}  // namespace relamp::ui
