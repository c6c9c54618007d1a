// Text made safe for HTML and SVG.
#pragma once
#include <string>

namespace relamp {

/// Text for an element or a quoted attribute.
inline std::string htmlText(const std::string& text) {
    std::string safe;
    for (char c : text) {
        switch (c) {
            case '&': safe += "&amp;"; break;
            case '<': safe += "&lt;"; break;
            case '>': safe += "&gt;"; break;
            case '"': safe += "&quot;"; break;
            default: safe += c;
        }
    }
    return safe;
}

}  // namespace relamp
