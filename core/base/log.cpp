#include "base/log.h"

#include <mutex>

namespace relamp {
namespace {
std::mutex mutex;
LogSink currentSink;
}  // namespace

void setLogSink(LogSink sink) {
    std::lock_guard lock(mutex);
    currentSink = std::move(sink);
}

void logLine(LogLevel level, const std::string& line) {
    std::lock_guard lock(mutex);
    if (currentSink) currentSink(level, line);
}

}  // namespace relamp
