// What the user typed. CLI11 is named only in command_line.cpp.
#pragma once
#include <optional>

#include "commands.h"
#include "report_command.h"
#include "scan_command.h"
#include "stress_command.h"

namespace relamp::cli {

enum class Verb { edit, check, plan, solve, render, exportShot, paint, compare, mergeHdr, report, scan, stress, info };

/// The verb, and the arguments of all of them; only the verb's own are filled.
struct CommandLine {
    Verb verb = Verb::info;
    std::string progressMode = "auto";
    bool quiet = false, json = false;
    std::string editPath;
    std::filesystem::path path;  ///< of check and info
    CaptureFix fix;              ///< of check and info
    SolveArguments solve;        ///< of solve and plan
    RenderArguments render;
    PaintArguments paint;
    ExportArguments exported;
    CompareArguments compare;
    MergeArguments merge;
    ReportArguments report;
    ScanArguments scan;
    StressArguments stress;
};

/// None when the program ends here: help or version was asked for, or the options are wrong.
std::optional<CommandLine> parseCommandLine(int argc, char** argv, int& exitCode);

}  // namespace relamp::cli
