// Copy and paste of lights, here or into another shot.
#pragma once
#include "editor.h"

namespace relamp::ui {

/// The selected lights into state.copied.
void copyLights(Editor& editor);
/// As new lights where they were; they are selected. A recovered light becomes a disk of its area.
void pasteLights(Editor& editor);
/// Exposure and colour of the copied light, on the selected ones.
void pasteLightValues(Editor& editor);

}  // namespace relamp::ui
