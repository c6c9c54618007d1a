// Key codes. Letters and digits are their ASCII capitals; the others have GLFW's numbers, so that window.cpp hands them
// through and nobody else needs GLFW's header.
#pragma once
#include <string>

namespace relamp::ui {

enum Key : int {
    keySpace = 32,
    keyComma = 44,
    keyMinus = 45,
    keyPeriod = 46,
    keyEqual = 61,
    keyEscape = 256,
    keyEnter = 257,
    keyTab = 258,
    keyBackspace = 259,
    keyDelete = 261,
    keyRight = 262,
    keyLeft = 263,
    keyDown = 264,
    keyUp = 265,
    keyHome = 268,
    keyF1 = 290,
    keyF2 = 291,
    keyF5 = 294,
    keyF11 = 300,
    keyF12 = 301,
    keyPad0 = 320,
    keyPadEnter = 335,
};
/// "Esc", "A", "F12".
std::string keyName(int key);

/// Modifiers and keys of the present frame, read from the window's own callbacks (Dear ImGui 1.86 has no names for
/// letters).
struct Input {
    bool control = false, shift = false, alt = false;
    std::string typed;  ///< characters typed since the last frame that no text field took
    int pressed = 0;    ///< key that went down since the last frame and that no text field took; 0: none
};
Input& input();

}  // namespace relamp::ui
