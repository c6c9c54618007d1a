#include "plan_command.h"

#include <cstdio>

#include <nlohmann/json.hpp>

#include "base/parallel.h"

namespace relamp::cli {

int plan(const SolveArguments& a, bool json, Progress& progress) {
    const ThreadLimit limit(a.threads);
    PipelineOptions options = pipelineOptions(a);
    options.onlyPlan = true;
    const SolvePlan plan = runPipeline(a.capture, options, progress).estimate.plan;
    std::fputs((json ? planJson(plan).dump(1) + "\n" : planText(plan)).c_str(), stdout);
    return 0;
}

}  // namespace relamp::cli
