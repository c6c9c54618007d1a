// What an artist does to the views that are kept, as functions on the look.
#pragma once
#include <string>

#include "relight/look.h"

namespace relamp {

/// Null where there is none of this name.
const CameraBookmark* bookmarkNamed(const Look& look, const std::string& name);
/// Joins the end of the list. An empty name: "Bookmark 1", ...; a name that is taken gets " (2)". The name it got.
std::string addBookmark(Look& look, CameraBookmark bookmark);
/// It shows this view from now on, under its old name. Nothing happens where there is none of this name.
void moveBookmark(Look& look, const std::string& name, CameraBookmark view);
/// Tidied (tidyName), and told apart from others by " (2)"; an empty name changes nothing. The name it got.
std::string renameBookmark(Look& look, const std::string& name, const std::string& wanted);
void deleteBookmark(Look& look, const std::string& name);

}  // namespace relamp
