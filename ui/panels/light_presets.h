// Lights kept under a name, for every shot: each a document of edits with the lights it adds, in the user's folder.
#pragma once
#include "editor.h"

namespace relamp::ui {

/// Names of what is kept, in order.
std::vector<std::string> lightPresets(const Editor& editor);
/// Keeps the selected lights under the name of the last of them, with a number where that is taken; a recovered light
/// becomes a disk of its area. Says the name, or what went wrong.
void saveLightPreset(Editor& editor);
/// Adds the lights of a preset where new lights go, the first at that place and the others about it; they are selected.
/// A file that cannot be read ends in a notice and no edit.
void addLightPreset(Editor& editor, const std::string& name);
void deleteLightPreset(Editor& editor, const std::string& name);
/// Their entries in the menu of new lights; none where nothing is kept.
void lightPresetItems(Editor& editor);

}  // namespace relamp::ui
