// Values with keys of their own against frames: of the selected lights, or of everything where none is selected.
#pragma once
#include "editor.h"

namespace relamp::ui {

/// Fills what is left of the panel.
void drawCurveView(Editor& editor);

}  // namespace relamp::ui
