// The editor's documents: saved, locked, recovered, and on disks that fail.
#include "editor.h"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>
#include <unistd.h>

#include "ui/editor_session.h"

namespace relamp::ui {
namespace {

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

TEST(Editor, whatWasOpenedIsRememberedBeforeACrash) {
    Session s;
    s.editor->openNow(captureFolder());
    s.until([&] { return !s.editor->job(); });
    EXPECT_NE(TemporaryFolder::read(s.folder / "config/settings.json").find(captureFolder().string()),
              std::string::npos);
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
    s.openEstimated();
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
    // No image at all as environment is no edit; the notice says why.
    s.folder.write("fake.exr", "no image");
    const size_t edits = s.editor->history().entries().size();
    s.editor->setEye(eyeAt(40, 30), false);
    s.editor->open(s.folder / "fake.exr");
    s.until([&] { return !s.editor->state.notices.empty(); });
    EXPECT_NE(s.editor->state.notices[0].text.find("fake.exr"), std::string::npos);
    s.editor->state.notices.clear();
    EXPECT_EQ(s.editor->history().entries().size(), edits);
    s.until([&] { return s.editor->liveFrame() != nullptr; });
    EXPECT_TRUE(s.editor->liveFrame());
    // A place that cannot be written.
    s.folder.write("file", "");
    s.editor->edit("Turn", [](Look& look) { look.environment.yawDegrees = 5; });
    s.editor->saveAs(s.folder / "file/shot");
    s.until([&] { return !s.editor->state.notices.empty(); });
    EXPECT_TRUE(s.editor->unsavedChanges());
}

TEST(Editor, aSecondEditorIsToldAndCannotOverwriteTheFirst) {
    Session first, second;
    first.openEstimated();
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
    s.openEstimated();
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
    s.solve();
    s.settle();
    ASSERT_NE(s.editor->estimate()->reflectance.weight, first->reflectance.weight);
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
    EXPECT_EQ(s.editor->estimate()->reflectance.weight, first->reflectance.weight);
}

TEST(Editor, photographsThatGoAwayTakeNothingWithThem) {
    Session s;
    test::paintSmallWorld(s.folder / "room");
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
    // The whole capture: it is asked for, and what was open stays when nobody knows.
    std::filesystem::rename(s.folder / "room", s.folder / "unplugged-too");
    s.editor->state.notices.clear();
    s.open(s.folder / "shot.relamp");
    ASSERT_TRUE(s.editor->state.missing);
    EXPECT_NE(s.editor->state.missing->path.string().find("room"), std::string::npos);
    s.editor->answerMissing(MissingAnswer::cancel);
    EXPECT_TRUE(s.editor->estimate());
}

}  // namespace
}  // namespace relamp::ui
