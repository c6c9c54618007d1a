// Looks as files, for other shots and for `relamp render --edits`: edits documents (docs/interface.md 3).
#pragma once
#include "editor.h"

namespace relamp::ui {

/// What of a look a shot can take.
struct LookHere {
    Look look;
    std::vector<std::string> lacking;  ///< what it names and the shot has not, in words, each once
};

/// Reads the environment's panorama, where the look has one: seconds for a large one. Plate and bookmarks are not
/// taken.
LookHere lookHere(const Look& look, const Estimate& estimate, size_t vertices);

/// Writes the present look, with its keys and without plate and bookmarks. A file that is there and is no look stays:
/// a notice says so, as of any other failure.
void saveLook(Editor& editor, const std::filesystem::path& file);
/// Reads a look in the background; then it takes the place of the present one as one edit. Plate and bookmarks stay.
/// What this shot lacks of it is named in a notice. A file that cannot be read ends in a notice and no edit.
void loadLook(Editor& editor, const std::filesystem::path& file);

}  // namespace relamp::ui
