#include "keys.h"

namespace relamp::ui {

std::string keyName(int key) {
    switch (key) {
        case 0: return "";
        case keySpace: return "Space";
        case keyComma: return ",";
        case keyMinus: return "-";
        case keyPeriod: return ".";
        case keyEqual: return "=";
        case keyEscape: return "Esc";
        case keyEnter: return "Enter";
        case keyTab: return "Tab";
        case keyBackspace: return "Backspace";
        case keyDelete: return "Del";
        case keyRight: return "Right";
        case keyLeft: return "Left";
        case keyDown: return "Down";
        case keyUp: return "Up";
        case keyHome: return "Home";
        case keyPad0: return "Num 0";
        case keyPadEnter: return "Num Enter";
        default: break;
    }
    if (key >= keyF1 && key < keyF1 + 12) return "F" + std::to_string(key - keyF1 + 1);
    if (key > 32 && key < 127) return std::string(1, char(key));
    return "?";
}

Input& input() {
    static Input current;
    return current;
}

}  // namespace relamp::ui
