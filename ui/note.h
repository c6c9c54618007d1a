// What the item map is told by controls; for the files of widgets.h alone.
#pragma once

namespace relamp::ui {

/// The item drawn last under the name on the screen, for tests that press real buttons.
void note(const char* label);

}  // namespace relamp::ui
