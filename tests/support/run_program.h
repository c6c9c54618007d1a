// Runs a program with its outputs caught.
#pragma once
#include <signal.h>

#include <string>
#include <vector>

#include "support/temporary_folder.h"

namespace relamp::test {

struct ProgramResult {
    int exitCode = -1;  ///< 128 + signal when it was killed
    std::string out, error;
};

/// Runs `arguments[0]`. With `interruptOn` it is sent `signalNumber` as soon as that text stands in its stderr.
ProgramResult runProgram(const std::vector<std::string>& arguments, const std::string& interruptOn = "",
                         int signalNumber = SIGINT);

}  // namespace relamp::test
