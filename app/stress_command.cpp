#include "stress_command.h"

#include <nlohmann/json.hpp>

#include "base/is_there.h"
#include "base/json_fields.h"
#include "base/parallel.h"
#include "capture/load_capture.h"
#include "print_result.h"
#include "report/stress.h"
#include "shot/shot_file.h"

namespace relamp::cli {

int stress(const StressArguments& a, Progress& progress) {
    const ThreadLimit limit(a.threads);
    const Capture capture =
        isThere(a.path / "shot.json") ? openShot(a.path, true, progress).capture : loadCapture(a.path, {}, progress);
    StressOptions options;
    options.only = a.only;
    const StressReport report = runStress(&capture, options, progress);
    printResult(a.json ? dumpJson(stressJson(report), 1) : stressText(report));
    for (const StressCase& c : report.cases)
        if (!c.holds()) return 4;
    return 0;
}

}  // namespace relamp::cli
