// Where controls are on the screen and what the editor is doing, written to a file after each frame: lets a test press
// real buttons with a real mouse without knowing the layout. Off, and free, unless RELAMP_ITEM_MAP names a file.
#pragma once
#include <string>

#include "editor.h"

namespace relamp::ui {

bool itemMapOn();
/// The item drawn last.
void noteItem(const std::string& name);
/// A rectangle in screen units.
void noteRect(const std::string& name, const Vec2& low, const Vec2& high);
/// A point in screen units.
void notePoint(const std::string& name, const Vec2& point);
/// Writes what was noted in this frame, and forgets it.
void writeItemMap(const Editor& editor);

}  // namespace relamp::ui
