// stdout carries results, whole or with an error.
#pragma once
#include <cerrno>
#include <cstdio>

#include "base/atomic_file.h"
#include "base/printable.h"

namespace relamp::cli {

/// Prints a result with a line's end. Throws Error, or OutOfResources for a full disk: a script must not take half a
/// result for a whole one.
inline void printResult(const std::string& text) {
    errno = 0;
    const std::string shown = printable(text, true);
    const bool ended = !shown.empty() && shown.back() == '\n';
    const bool whole = std::fputs(shown.c_str(), stdout) >= 0 && (ended || std::fputc('\n', stdout) >= 0);
    if (std::fflush(stdout) != 0 || !whole) throwWriteFailure("standard output", errno);
}

}  // namespace relamp::cli
