// Numbers as people read them.
#pragma once
#include <fmt/format.h>

#include <cmath>
#include <string>

namespace relamp {

/// `digits` significant digits, without an exponent for what is below ten million: "0.0123", "1.23", "100", "12346".
inline std::string significant(double value, int digits) {
    const std::string words = fmt::format("{:.{}g}", value, digits);
    const double size = std::abs(value);
    return size >= 1 && size < 1e7 && words.find('e') != std::string::npos ? fmt::format("{:.0f}", value) : words;
}

}  // namespace relamp
