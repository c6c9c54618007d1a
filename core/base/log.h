// Log lines go to a sink the program sets; the core prints nothing itself.
#pragma once
#include <fmt/format.h>

#include <functional>
#include <string>

namespace relamp {

enum class LogLevel { info, warning };
using LogSink = std::function<void(LogLevel, const std::string&)>;

/// Sets where log lines go (thread-safe; an empty sink drops them).
void setLogSink(LogSink sink);
void logLine(LogLevel level, const std::string& line);

template <class... Args>
void logInfo(fmt::format_string<Args...> format, Args&&... args) {
    logLine(LogLevel::info, fmt::format(format, std::forward<Args>(args)...));
}
template <class... Args>
void logWarning(fmt::format_string<Args...> format, Args&&... args) {
    logLine(LogLevel::warning, fmt::format(format, std::forward<Args>(args)...));
}

}  // namespace relamp
