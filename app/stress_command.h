// The verb `stress`.
#pragma once
#include "commands.h"

namespace relamp::cli {

struct StressArguments {
    fs::path path;     ///< capture or shot
    std::string only;  ///< cases whose name holds this text
    bool json = false;
    int threads = 0;
};

/// The stability table on standard output. 0, or 4 when a case did not hold: not finite, or not solved and no reason
/// given.
int stress(const StressArguments& arguments, Progress& progress);

}  // namespace relamp::cli
