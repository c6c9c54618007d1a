#include "edit/bookmark_edits.h"

#include "edit/free_name.h"

namespace relamp {

const CameraBookmark* bookmarkNamed(const Look& look, const std::string& name) { return namedIn(look.bookmarks, name); }

std::string addBookmark(Look& look, CameraBookmark bookmark) {
    bookmark.name = tidyName(bookmark.name);
    bookmark.name =
        bookmark.name.empty() ? nextName(look.bookmarks, "Bookmark") : freeName(look.bookmarks, bookmark.name);
    look.bookmarks.push_back(std::move(bookmark));
    return look.bookmarks.back().name;
}

void moveBookmark(Look& look, const std::string& name, CameraBookmark view) {
    CameraBookmark* bookmark = namedIn(look.bookmarks, name);
    if (!bookmark) return;
    view.name = name;
    *bookmark = std::move(view);
}

std::string renameBookmark(Look& look, const std::string& name, const std::string& wanted) {
    return renameIn(look.bookmarks, name, wanted);
}

void deleteBookmark(Look& look, const std::string& name) {
    std::erase_if(look.bookmarks, [&](const CameraBookmark& one) { return one.name == name; });
}

}  // namespace relamp
