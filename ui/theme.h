// The look of the window: neutral greys, because people judge colour in it, and one restrained accent.
#pragma once
#include <imgui.h>

namespace relamp::ui {

/// Colours and spacing at `scale` (1: a 96 dpi screen). Fonts are loaded elsewhere. May be called again when the scale
/// changes.
void applyTheme(float scale);

/// Signal colours, used for text and small marks only.
inline const ImVec4 accentColour{0.42f, 0.58f, 0.76f, 1};
inline const ImVec4 warningColour{0.93f, 0.72f, 0.36f, 1};
inline const ImVec4 errorColour{0.94f, 0.50f, 0.46f, 1};
inline const ImVec4 goodColour{0.56f, 0.78f, 0.56f, 1};
inline const ImVec4 dimColour{0.64f, 0.64f, 0.64f, 1};

}  // namespace relamp::ui
