// Keys of single values at their controls: a mark on a field that is keyed, and a menu under the right button.
#pragma once
#include "edit/value_key_edits.h"
#include "editor.h"

namespace relamp::ui {

/// For tooltips of controls that have the menu.
inline constexpr const char* keysHint = "\nRight click: keys of this value.";

/// That value of each of these lights or groups.
std::vector<KeyedOf> valuesOf(KeyedValue value, const std::vector<std::string>& ids);
/// Brightness and colour of each of these lights, in the form that its kind has.
std::vector<KeyedOf> powersOf(const Editor& editor, const std::vector<std::string>& ids);
/// "Exposure and colour of Light 1".
std::string nameOfValues(const Editor& editor, const std::vector<KeyedOf>& values);

/// Follows the control drawn last, which shows the first of `values`: orange mark: keyed at this frame; blue: it has
/// keys at others. Right click: set, delete, previous and next key.
void valueKeyMenu(Editor& editor, const std::vector<KeyedOf>& values);

}  // namespace relamp::ui
