#include "report_command.h"

#include "base/parallel.h"
#include "print_result.h"
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
    printResult(a.output.string());
    return 0;
}

}  // namespace relamp::cli
