// The verb `report`.
#pragma once
#include "commands.h"

namespace relamp::cli {

struct ReportArguments {
    fs::path shot, output, truth;
    std::string againstDistant = "auto";
    int threads = 0;
};

int report(const ReportArguments& arguments, Progress& progress);

}  // namespace relamp::cli
