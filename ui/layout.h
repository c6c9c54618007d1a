// Where everything is: menu, three columns, bottom strip, status bar.
#pragma once
#include <string>

#include "editor.h"

namespace relamp::ui {

class Viewport;

/// Draws the whole window for one frame. `viewport` is null where the driver is too old; `reason` then says why.
void drawLayout(Editor& editor, Viewport* viewport, const std::string& reason);

}  // namespace relamp::ui
