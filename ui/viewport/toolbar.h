// The bar above the image: view modes, tools, axes, exposure, view transform. Wraps and shortens itself in narrow
// viewports.
#pragma once
#include "editor.h"

namespace relamp::ui {

/// Draws at the cursor over the whole width of the window.
void drawViewportToolbar(Editor& editor);

}  // namespace relamp::ui
