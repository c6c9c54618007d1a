// The verb `plan`.
#pragma once
#include "commands.h"

namespace relamp::cli {

/// What a solve with these options would do and leave out, on standard output.
int plan(const SolveArguments& arguments, bool json, Progress& progress);

}  // namespace relamp::cli
