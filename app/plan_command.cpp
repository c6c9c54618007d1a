#include "plan_command.h"

#include <cstdio>

#include <nlohmann/json.hpp>

#include "base/parallel.h"

namespace relamp::cli {

int plan(const SolveArguments& a, bool json, Progress& progress) {
    const ThreadLimit limit(a.threads);
    PipelineOptions options = pipelineOptions(a);
    options.onlyPlan = true;
    const PipelineResult r = runPipeline(a.capture, options, progress);
    nlohmann::json document = planJson(r.estimate.plan);
    std::string text = planText(r.estimate.plan);
    if (r.search) {
        document["unseen_lamp"] = {{"found", r.search->light.has_value()}, {"words", r.search->words}};
        if (const auto& light = r.search->light) {
            const DVec3 place = r.capture.origin + DVec3(light->position);
            document["unseen_lamp"]["position"] = {place.x, place.y, place.z};
        }
        text += r.search->words + "\n";
    }
    std::fputs((json ? document.dump(1) + "\n" : text).c_str(), stdout);
    return 0;
}

}  // namespace relamp::cli
