// The verb `scan`.
#pragma once
#include "commands.h"

namespace relamp::cli {

struct ScanArguments {
    fs::path folder, output, cameras;  ///< `cameras` empty: cameras.json in the folder
    std::string bits, projector, up;   ///< "N,M", "WxH", as --up of captures; empty: found
    double mostGap = 0;                ///< millimetres; 0: four times the median
    size_t triangles = 300'000;
    bool json = false, overwrite = false;
    int threads = 0;
};

/// Photographs of Gray-code patterns become a capture; the report goes to standard output.
int scan(const ScanArguments& arguments, Progress& progress);

}  // namespace relamp::cli
