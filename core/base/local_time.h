// The wall clock as people read it.
#pragma once
#include <ctime>
#include <string>

namespace relamp {

/// "2026-01-31 18:05:00", in the zone of this machine.
inline std::string localTime() {
    const std::time_t now = std::time(nullptr);
    std::tm parts{};
    localtime_r(&now, &parts);
    char text[32];
    std::strftime(text, sizeof text, "%Y-%m-%d %H:%M:%S", &parts);
    return text;
}

}  // namespace relamp
