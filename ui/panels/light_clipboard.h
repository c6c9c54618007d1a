// Copy and paste of lights, here or into another shot.
#pragma once
#include "editor.h"

namespace relamp::ui {

/// Lights as a shot of any capture can take them: a recovered one becomes a disk of its area.
std::vector<AddedEmitter> asAddedLights(const Editor& editor, const std::vector<std::string>& ids);
/// The selected lights into state.copied.
void copyLights(Editor& editor);
/// As new lights where they were; they are selected.
void pasteLights(Editor& editor);
/// Exposure and colour of the copied light, on the selected ones.
void pasteLightValues(Editor& editor);

}  // namespace relamp::ui
