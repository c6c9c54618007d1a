#include "edit/bookmark_edits.h"

#include <algorithm>

#include "base/error.h"

namespace relamp {
namespace {

CameraBookmark* ownBookmark(Look& look, const std::string& name) {
    for (CameraBookmark& bookmark : look.bookmarks)
        if (bookmark.name == name) return &bookmark;
    return nullptr;
}

std::string freeBookmarkName(Look& look, const std::string& wanted) {
    std::string name = wanted;
    for (int n = 2; ownBookmark(look, name); ++n) name = fmt::format("{} ({})", wanted, n);
    return name;
}

}  // namespace

const CameraBookmark* bookmarkNamed(const Look& look, const std::string& name) {
    const auto at = std::find_if(look.bookmarks.begin(), look.bookmarks.end(),
                                 [&](const CameraBookmark& one) { return one.name == name; });
    return at == look.bookmarks.end() ? nullptr : &*at;
}

std::string addBookmark(Look& look, CameraBookmark bookmark) {
    bookmark.name = tidyName(bookmark.name);
    for (int n = 1; bookmark.name.empty(); ++n)
        if (const std::string next = fmt::format("Bookmark {}", n); !ownBookmark(look, next)) bookmark.name = next;
    bookmark.name = freeBookmarkName(look, bookmark.name);
    look.bookmarks.push_back(std::move(bookmark));
    return look.bookmarks.back().name;
}

void moveBookmark(Look& look, const std::string& name, CameraBookmark view) {
    CameraBookmark* bookmark = ownBookmark(look, name);
    if (!bookmark) return;
    view.name = name;
    *bookmark = std::move(view);
}

std::string renameBookmark(Look& look, const std::string& name, const std::string& wanted) {
    const std::string tidy = tidyName(wanted);
    CameraBookmark* bookmark = ownBookmark(look, name);
    if (!bookmark || tidy.empty() || tidy == name) return name;
    const std::string free = freeBookmarkName(look, tidy);
    bookmark->name = free;
    return free;
}

void deleteBookmark(Look& look, const std::string& name) {
    std::erase_if(look.bookmarks, [&](const CameraBookmark& one) { return one.name == name; });
}

}  // namespace relamp
