// The command palette and the dialogs, with keys and a mouse.
#include "panels/dialogs.h"

#include "actions.h"
#include "panels/export_dialog.h"
#include "panels/panels.h"
#include "ui/panels/panel_harness.h"

namespace relamp::ui::test {
namespace {

TEST(Palette, aFewLettersAndEnterRunACommand) {
    Panels p;
    p.openSolved();
    p.editor->state.panels.palette = true;
    p.frame({});
    p.frames(3);
    p.type("neutral");
    p.key(keyEnter);
    p.frames(2);
    EXPECT_TRUE(p.editor->look().neutralMaterials);
    EXPECT_FALSE(p.editor->state.panels.palette);
    EXPECT_FALSE(dialogOpen(*p.editor));
}

TEST(Palette, arrowsChooseAndEscCloses) {
    Panels p;
    p.editor->state.panels.palette = true;
    p.frame({});
    p.frames(3);
    p.key(keyDown);
    p.key(keyEscape);
    p.frames(2);
    EXPECT_FALSE(p.editor->state.panels.palette);
}

TEST(Palette, startsOfWordsAndRunsCountMore) {
    EXPECT_LT(fuzzyScore("Open...", "xyz"), 0);
    EXPECT_GT(fuzzyScore("Save as...", "sa"), fuzzyScore("Neutral surfaces", "sa"));
    EXPECT_GT(fuzzyScore("Add rectangle", "rect"), fuzzyScore("Correction colours", "rect"));
    EXPECT_GT(fuzzyScore("Export frames...", "exp fr"), 0);
    EXPECT_GT(fuzzyScore("Open...", ""), -100);
}

TEST(Dialogs, noticesCloseOneByOneWithEnter) {
    Panels p;
    p.editor->fail("First", "This went wrong.", "Do that.");
    p.editor->fail("Second", "That too.");
    p.frame({});
    p.frames(3);
    EXPECT_TRUE(dialogOpen(*p.editor));
    p.key(keyEnter);
    p.frames(3);
    ASSERT_EQ(p.editor->state.notices.size(), 1u);
    EXPECT_EQ(p.editor->state.notices[0].title, "Second");
    p.key(keyEscape);
    p.frames(3);
    EXPECT_TRUE(p.editor->state.notices.empty());
    EXPECT_EQ(ImGui::GetCurrentContext()->OpenPopupStack.Size, 0);
}

TEST(Dialogs, aNoticeOverAnotherDialogGivesItBack) {
    Panels p;
    p.openSolved();
    p.editor->state.panels.exportFrames = true;
    p.frame({});
    p.frames(3);
    p.editor->fail("Trouble", "Something happened.");
    p.frames(3);
    p.key(keyEnter);
    p.frames(3);
    EXPECT_TRUE(p.editor->state.notices.empty());
    EXPECT_TRUE(p.editor->state.panels.exportFrames);
    EXPECT_TRUE(ImGui::IsPopupOpen("", ImGuiPopupFlags_AnyPopupId | ImGuiPopupFlags_AnyPopupLevel));
}

TEST(Dialogs, unsavedWorkIsAskedAboutAndCancelStays) {
    Panels p;
    p.openSolved();
    p.editor->edit("Neutral", [](Look& look) { look.neutralMaterials = true; });
    p.editor->requestQuit();
    p.frame({});
    p.frames(3);
    EXPECT_TRUE(dialogOpen(*p.editor));
    p.key(keyEscape);
    p.frames(3);
    EXPECT_FALSE(p.editor->quitting());
    EXPECT_FALSE(p.editor->state.unsaved);
}

TEST(Dialogs, theBrowserBeginsBesideWhatIsOpenAndStaysWhereItWasLeft) {
    Panels p;
    p.openSolved();
    const auto folderAfter = [&](const std::function<void()>& there) {
        p.editor->state.panels.openBrowser = true;
        p.frame({});
        p.frames(3);
        const std::filesystem::path folder = browserFolder();
        there();
        p.key(keyEscape);
        p.frames(3);
        EXPECT_FALSE(dialogOpen(*p.editor));
        return folder;
    };
    const std::filesystem::path beside = PaintedRoom::get().shot.parent_path();
    EXPECT_EQ(folderAfter([&] { p.key(keyBackspace), p.frames(3); }), beside);
    EXPECT_EQ(folderAfter([] {}), beside.parent_path()) << "cancelling forgets nothing";
    p.editor->saveAs(p.folder / "mine.relamp");
    p.until([&] { return p.editor->state.document.shotFolder == p.folder / "mine.relamp"; });
    EXPECT_EQ(folderAfter([] {}), p.folder.path()) << "what is open now lies elsewhere";
}

TEST(Dialogs, onlyOneThatIsHigherThanTheScreenScrolls) {
    Panels p;
    p.openCapture();
    p.editor->state.plateImport = PlateLook{};
    p.frame({});
    const auto scrolls = [&] {
        p.frames(4);
        const ImGuiWindow* window = ImGui::FindWindowByName("Import plate###plate");
        return window && window->ScrollbarY;
    };
    for (int size = 0; size < 20; ++size) {
        ImGui::GetIO().FontGlobalScale = 1 + 0.043f * float(size);
        EXPECT_FALSE(scrolls()) << size;
    }
    ImGui::GetIO().DisplaySize.y = 200;
    EXPECT_TRUE(scrolls());
    ImGui::GetIO().FontGlobalScale = 1;
}

TEST(Dialogs, lostWorkIsDiscardedByTwoPressesNotByOne) {
    Panels p;
    p.openSolved();
    p.editor->edit("Neutral", [](Look& look) { look.neutralMaterials = true; });
    p.editor->state.recovery = RecoveryOffer{};
    p.frame({});
    p.frames(3);
    const auto discard = p.find(Panels::idOf("Work from before a crash###recovery", {"###discard"}));
    ASSERT_TRUE(discard);
    p.click(*discard);
    EXPECT_TRUE(p.editor->state.recovery) << "asked once more";
    p.editor->state.recovery.reset();
    p.frames(3);
    p.editor->state.recovery = RecoveryOffer{};
    p.frames(3);
    p.click(*discard);
    EXPECT_TRUE(p.editor->state.recovery) << "the first press of an earlier offer does not count";
}

TEST(ExportDialog, enterExportsAndLeavingAsksWhileItRuns) {
    Panels p;
    p.openSolved();
    Editor& editor = *p.editor;
    ExportRequest& r = editor.state.exportFrames;
    r.views = ExportRequest::Views::all;
    r.layers = "";
    r.width = r.height = 8;
    editor.state.panels.exportFrames = true;
    p.frame({});
    p.frames(3);
    p.key(keyEnter);
    p.frames(2);
    EXPECT_FALSE(editor.job()) << "without a file there is nothing to start";
    r.file = p.folder / "frame.####.exr";
    p.frames(2);
    // Enter that ends a field only ends it.
    const auto field = p.find(Panels::idOf("Export frames###export", {"##file"}));
    ASSERT_TRUE(field);
    p.click(*field);
    p.key(keyEnter);
    p.frames(2);
    EXPECT_FALSE(editor.job());
    p.key(keyEnter);
    ASSERT_TRUE(editor.job());
    EXPECT_EQ(editor.job()->kind, JobStatus::Kind::exportFrames);
    editor.pauseJob(true);
    editor.requestQuit();
    EXPECT_FALSE(editor.quitting()) << "the frames would be lost";
    ASSERT_TRUE(editor.state.unsaved);
    EXPECT_FALSE(editor.state.unsaved->edits);
    p.frames(3);
    p.key(keyEscape);
    p.frames(3);
    EXPECT_FALSE(editor.state.unsaved);
    EXPECT_FALSE(editor.quitting());
    ASSERT_TRUE(editor.job());
    // Once the frames are there, the question has lost its reason.
    editor.requestQuit();
    p.frames(2);
    EXPECT_FALSE(editor.quitting());
    editor.pauseJob(false);
    p.until([&] { return !editor.job(); });
    p.frames(3);
    EXPECT_TRUE(editor.quitting());
}

TEST(ExportDialog, saysWhatIsWrongBeforeItStarts) {
    const TemporaryFolder folder;
    ExportRequest r;
    r.views = ExportRequest::Views::all;
    r.file = folder / "frame.exr";
    EXPECT_NE(checkExport(r, 6, 0).file.find("####"), std::string::npos);
    r.file = folder / "frame.####.exr";
    EXPECT_TRUE(checkExport(r, 6, 0).ok());
    EXPECT_EQ(checkExport(r, 6, 0).firstFile, "frame.0001.exr");
    EXPECT_EQ(checkExport(r, 6, 0).frames, 6u);
    r.file = folder / "frame.%03d.png";
    EXPECT_EQ(checkExport(r, 6, 0).firstFile, "frame.001.png");
    EXPECT_FALSE(checkExport(r, 6, 0).layers.empty());
    r.views = ExportRequest::Views::range;
    r.range = "2-4,9";
    EXPECT_EQ(checkExport(r, 6, 0).frames, 3u);
    for (const char* bad : {"", "x", "4-2", "1:0", "99"}) {
        r.range = bad;
        EXPECT_FALSE(checkExport(r, 6, 0).range.empty()) << bad;
    }
    r.views = ExportRequest::Views::present;
    r.file = folder / "nowhere" / "a.exr";
    EXPECT_NE(checkExport(r, 6, 0).file.find("does not exist"), std::string::npos);
    r.file = folder / "a.mov";
    EXPECT_FALSE(checkExport(r, 6, 0).ok());
    r.file = "";
    EXPECT_FALSE(checkExport(r, 6, 0).ok());
}

TEST(ExportDialog, offersPngAndJpegAsTheWindowShowsTheImage) {
    Panels p(700, 700);
    p.openSolved();
    EditorState& state = p.editor->state;
    const auto dialog = [&] { drawExportDialog(*p.editor); };
    state.exportFrames.file = p.folder / "frame.exr";
    EXPECT_EQ(p.wordsOf(dialog).find("As in the window"), std::string::npos);
    state.exportFrames.file = p.folder / "frame.png";
    EXPECT_NE(p.wordsOf(dialog).find("As in the window: Soft highlights"), std::string::npos);
    state.viewport.exposureStops = 1;
    state.viewport.displayView = "Standard";
    EXPECT_NE(p.wordsOf(dialog).find("As in the window: Standard, +1.0 stops"), std::string::npos);
    state.exportFrames.view = DisplayView::raw;
    EXPECT_NE(p.wordsOf(dialog).find("Without a curve"), std::string::npos);
}

TEST(Dialogs, aLookIsSavedUnderTheShotsNameBesideTheLastOne) {
    Panels p;
    p.openSolved();
    p.editor->state.recentLooks = {p.folder / "old.json"};
    ASSERT_TRUE(runAction(*p.editor, "file.saveLook"));
    EXPECT_TRUE(dialogOpen(*p.editor));
    p.frame({});
    p.frames(4);
    EXPECT_EQ(browserFolder(), p.folder.path());
    p.key(keyEnter);
    p.frames(3);
    EXPECT_FALSE(dialogOpen(*p.editor));
    const std::filesystem::path file = p.folder / "room look.json";
    EXPECT_TRUE(std::filesystem::exists(file));
    EXPECT_EQ(p.editor->state.recentLooks.front(), file);
}

}  // namespace
}  // namespace relamp::ui::test
