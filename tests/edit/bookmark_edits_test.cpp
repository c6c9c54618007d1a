// Views that are kept: added, renamed, moved, deleted.
#include "edit/bookmark_edits.h"

#include <gtest/gtest.h>

#include "edit/emitter_edits.h"
#include "edit/look_keys.h"

namespace relamp {
namespace {

TEST(BookmarkEdits, NamesAreGivenAndToldApart) {
    Look look;
    CameraBookmark view;
    view.distance = 2;
    EXPECT_EQ(addBookmark(look, view), "Bookmark 1");
    EXPECT_EQ(addBookmark(look, view), "Bookmark 2");
    EXPECT_EQ(renameBookmark(look, "Bookmark 1", " Door "), "Door");
    EXPECT_EQ(renameBookmark(look, "Bookmark 2", "Door"), "Door (2)");
    EXPECT_EQ(renameBookmark(look, "Door", ""), "Door");
    EXPECT_EQ(addBookmark(look, view), "Bookmark 1");
    view.distance = 7;
    moveBookmark(look, "Door", view);
    ASSERT_TRUE(bookmarkNamed(look, "Door"));
    EXPECT_EQ(bookmarkNamed(look, "Door")->distance, 7);
    deleteBookmark(look, "Door");
    EXPECT_FALSE(bookmarkNamed(look, "Door"));
    EXPECT_EQ(look.bookmarks.size(), 2u);
}

TEST(BookmarkEdits, SetNoKeyAndStayWhenTheLookIsReset) {
    Look look;
    setKey(look, 4);
    const Look before = look;
    addBookmark(look, {});
    keyEdit(before, look, 9);
    ASSERT_EQ(look.keys.size(), 1u) << "a view is no light, so it sets no key";
    EXPECT_TRUE(look.keys[0].look.bookmarks.empty());
    setKey(look, 4);
    EXPECT_TRUE(look.keys[0].look.bookmarks.empty());
    resetLook(look);
    EXPECT_EQ(look.bookmarks.size(), 1u);
}

}  // namespace
}  // namespace relamp
