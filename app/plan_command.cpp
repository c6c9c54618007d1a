#include "plan_command.h"

#include <nlohmann/json.hpp>

#include "base/json_fields.h"
#include "base/parallel.h"
#include "base/printable.h"
#include "capture/check.h"
#include "print_result.h"

namespace relamp::cli {

int plan(const SolveArguments& a, bool json, Progress& progress) {
    const ThreadLimit limit(a.threads);
    PipelineOptions options = pipelineOptions(a);
    options.onlyPlan = true;
    const PipelineResult r = runPipeline(a.capture, options, progress);
    nlohmann::json document = planJson(r.estimate.plan);
    std::string text = planText(r.estimate.plan);
    for (const auto& [name, views] : viewsOfStates(r.capture)) {
        nlohmann::json state{{"name", name}, {"views", views}};
        if (const size_t s = document["states"].size(); s < r.capture.environmentOfState.size())
            state["environment"] = environmentInWords(r.capture, s);
        text += fmt::format("Lighting state {}: {} views{}.\n", printable(name), views,
                            state.contains("environment")
                                ? ", environment: " + printable(state["environment"].get<std::string>())
                                : "");
        document["states"].push_back(std::move(state));
    }
    if (r.search) {
        nlohmann::json& found = document["unobserved_light"];
        found = {{"found", !r.search->lights.empty()}, {"words", r.search->words}};
        for (const UnobservedLight& light : r.search->lights) {
            const DVec3 place = r.capture.origin + DVec3(light.position);
            nlohmann::json one{{"position", {place.x, place.y, place.z}},
                               {"position_stddev", {light.sigma().x, light.sigma().y, light.sigma().z}},
                               {"fraction", light.fraction},
                               {"standard_errors", light.certainty}};
            if (!light.lobe.even())
                one["lobe"] = {{"axis", {light.lobe.axis.x, light.lobe.axis.y, light.lobe.axis.z}},
                               {"power", light.lobe.power}};
            if (!found.contains("position")) found["position"] = one["position"];
            found["lights"].push_back(std::move(one));
        }
        document["unseen_lamp"] = found;  // the name of version 1, for scripts
        text += r.search->words + "\n";
    }
    printResult(json ? dumpJson(document, 1) : text);
    return 0;
}

}  // namespace relamp::cli
