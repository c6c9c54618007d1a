#include "report_command.h"

#include <cstdio>

#include "base/parallel.h"
#include "report/solve_report.h"

namespace relamp::cli {

int report(const ReportArguments& a, Progress& progress) {
    const ThreadLimit limit(a.threads);
    if (a.output.extension() != ".html")
        throw UsageError("-o " + a.output.string() + ": expected a name that ends in .html");
    ReportOptions options;
    using Distant = ReportOptions::Distant;
    options.againstDistant = a.againstDistant == "on"    ? Distant::on
                             : a.againstDistant == "off" ? Distant::off
                                                         : Distant::automatic;
    options.truth = a.truth;
    writeReport(a.shot, a.output, options, progress);
    std::puts(a.output.string().c_str());
    return 0;
}

}  // namespace relamp::cli
