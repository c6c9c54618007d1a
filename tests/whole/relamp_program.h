// The command line's program as a test runs it.
#pragma once
#include <csignal>

#include "support/run_program.h"

namespace relamp::test {

/// `relamp ARGUMENTS`; a signal is sent when it says `interruptOn`.
inline ProgramResult relamp(std::vector<std::string> arguments, const std::string& interruptOn = "",
                            int signalNumber = SIGINT) {
    arguments.insert(arguments.begin(), RELAMP_BINARY);
    return runProgram(arguments, interruptOn, signalNumber);
}

}  // namespace relamp::test
