// The command line's program as a test runs it.
#pragma once
#include <gtest/gtest.h>

#include <algorithm>
#include <csignal>

#include "support/run_program.h"

namespace relamp::test {

/// `relamp ARGUMENTS`; a signal is sent when it says `interruptOn`.
inline ProgramResult relamp(std::vector<std::string> arguments, const std::string& interruptOn = "",
                            int signalNumber = SIGINT) {
    arguments.insert(arguments.begin(), RELAMP_BINARY);
    return runProgram(arguments, interruptOn, signalNumber);
}

inline size_t linesOf(const std::string& text) { return size_t(std::count(text.begin(), text.end(), '\n')); }

/// Bad input: exit code 3, nothing on stdout, and one sentence at the end of stderr that holds each of `words`.
inline void expectBadInput(const ProgramResult& r, const std::vector<std::string>& words) {
    EXPECT_EQ(r.exitCode, 3) << r.error;
    EXPECT_EQ(r.out, "");
    ASSERT_FALSE(r.error.empty());
    const size_t begin = ("\n" + r.error).rfind("\nrelamp: ");
    ASSERT_NE(begin, std::string::npos) << r.error;
    const std::string last = r.error.substr(begin);
    EXPECT_EQ(linesOf(last), 1u) << last;
    for (const std::string& word : words)
        EXPECT_NE(last.find(word), std::string::npos) << "expected " << word << " in: " << last;
}

}  // namespace relamp::test
