// Views that are kept, by the buttons below the photographs.
#include "actions.h"
#include "panels/panels.h"
#include "ui/panels/panel_harness.h"
#include "viewport/navigation.h"

namespace relamp::ui::test {
namespace {

TEST(Bookmarks, keepAViewAndGoBackToIt) {
    Panels p(420, 900);
    p.openSolved();
    Editor& e = *p.editor;
    p.frame([&] { drawViewsPanel(e); });
    p.frames(3);
    const auto keep = p.find(Panels::idOf("test", {"##bookmark"}));
    ASSERT_TRUE(keep);
    p.click(*keep);
    ASSERT_EQ(e.look().bookmarks.size(), 1u);
    p.frames(2);
    const CameraBookmark first = e.look().bookmarks[0];
    EXPECT_EQ(first.name, "Bookmark 1");
    EXPECT_TRUE(presentBookmark(e));
    OrbitCamera& camera = e.state.viewport.camera;
    camera.orbit({80, 20});
    EXPECT_FALSE(presentBookmark(e));
    const auto entry = p.find(Panels::idOf("test", {"Bookmark 1", "###bookmark"}));
    ASSERT_TRUE(entry);
    p.click(*entry);
    EXPECT_TRUE(presentBookmark(e));
    EXPECT_EQ(camera.azimuth, first.azimuth);
    EXPECT_EQ(camera.target, first.target);

    // A photograph's view is kept as an orbit shows it, and a bookmark leaves the photograph.
    lookThrough(e, 2);
    bookmarkView(e);
    ASSERT_EQ(e.look().bookmarks.size(), 2u);
    EXPECT_TRUE(looksThrough(e));
    nextBookmark(e);
    EXPECT_FALSE(looksThrough(e));
    EXPECT_EQ(presentBookmark(e)->name, "Bookmark 1");
    nextBookmark(e);
    EXPECT_EQ(presentBookmark(e)->name, "Bookmark 2");
    const float kept = camera.azimuth;
    lookThrough(e, 2);
    leaveView(e);
    EXPECT_EQ(camera.azimuth, kept);
    nextBookmark(e);
    EXPECT_EQ(presentBookmark(e)->name, "Bookmark 1") << "they go round";

    // Each change is one edit.
    p.frames(2);
    const auto removal = p.find(Panels::idOf("test", {"Bookmark 1", "##delete"}));
    ASSERT_TRUE(removal);
    p.click(*removal);
    ASSERT_EQ(e.look().bookmarks.size(), 1u);
    e.undo();
    EXPECT_EQ(e.look().bookmarks.size(), 2u);
    e.undo();
    e.undo();
    EXPECT_TRUE(e.look().bookmarks.empty());
    e.redo();
    EXPECT_EQ(e.look().bookmarks[0], first);
}

TEST(Bookmarks, areKeptWithTheShotAndNoSnapshotTakesThemAway) {
    Panels p;
    p.openSolved();
    Editor& e = *p.editor;
    e.storeSnapshot(0);
    bookmarkView(e);
    const std::vector<CameraBookmark> kept = e.look().bookmarks;
    ASSERT_EQ(kept.size(), 1u);
    const size_t entries = e.history().index();
    e.recallSnapshot(0);
    EXPECT_EQ(e.history().index(), entries) << "a snapshot is of the light: there is nothing to go back to";
    e.setKey();
    e.goToFrame(7);
    EXPECT_EQ(e.look().bookmarks, kept);
    e.saveAs(p.folder / "kept.relamp");
    p.until([&] { return !e.unsavedChanges(); });
    e.openNow(p.folder / "kept.relamp");
    p.until([&] { return !e.job() && e.estimate(); });
    ASSERT_EQ(e.look().bookmarks.size(), 1u);
    EXPECT_EQ(e.look().bookmarks[0].name, kept[0].name);
    EXPECT_NEAR(e.look().bookmarks[0].azimuth, kept[0].azimuth, 1e-5f);
    EXPECT_LT(glm::length(e.look().bookmarks[0].target - kept[0].target), 1e-5f);
}

}  // namespace
}  // namespace relamp::ui::test
