// Values with keys of their own against frames: of the selected lights, or of everything where none is selected.
#pragma once
#include "editor.h"

namespace relamp::ui {

/// Pixels left of the curves, for their names; 0 where there are none.
float curveListWidth(const Editor& editor);
/// Fills what is left of the panel.
void drawCurveView(Editor& editor);

}  // namespace relamp::ui
