// Text from files and names as it may be shown: control characters could clear a terminal or forge a line.
#pragma once
#include <string>
#include <string_view>

namespace relamp {

/// Control characters (C0, DEL, and C1 in UTF-8) as \xNN; with `keepLines` line ends and tabs stay.
inline std::string printable(std::string_view text, bool keepLines = false) {
    constexpr char digits[] = "0123456789abcdef";
    std::string shown;
    shown.reserve(text.size());
    const auto escape = [&](unsigned char c) { (shown += "\\x") += {digits[c >> 4], digits[c & 15]}; };
    for (size_t i = 0; i < text.size(); ++i) {
        const auto c = static_cast<unsigned char>(text[i]);
        const auto next = i + 1 < text.size() ? static_cast<unsigned char>(text[i + 1]) : 0;
        if (c == 0xc2 && next >= 0x80 && next < 0xa0) {
            escape(c);
            escape(next);
            ++i;
        } else if ((c < 0x20 || c == 0x7f) && !(keepLines && (c == '\n' || c == '\t'))) escape(c);
        else shown += char(c);
    }
    return shown;
}

/// "1 light", "6 lights".
inline std::string counted(size_t n, std::string_view noun) {
    return std::to_string(n) + " " + std::string(noun) + (n == 1 ? "" : "s");
}

}  // namespace relamp
