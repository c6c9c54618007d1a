// How fast this machine does the solver's kinds of work, measured in a few hundredths of a second. Not a door.
#pragma once
#include "base/progress.h"

namespace relamp {

/// Seconds for one unit of work, with all threads that may be used, as busy as the machine is now.
struct MachineSpeed {
    double gramPerColumn = 0;  ///< times rows x columns: weighted sums of a dozen rows, all channels
    double gramPerSquare = 0;  ///< times rows x columns^2: products, all channels
    double factorPerCube = 0;  ///< times columns^3: a bounded program
    double bytes = 0;          ///< times bytes of a large matrix read once
    double sparse = 0;         ///< times vertices x log2 of them: two reweighted solves of the albedo, three channels
};

/// Cost about 0.1 s.
MachineSpeed measureMachine(Progress& progress);

}  // namespace relamp
