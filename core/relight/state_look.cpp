#include "relight/state_look.h"

#include <algorithm>

namespace relamp {

Look withLevels(Look look, const std::vector<EmitterCluster>& emitters, const std::vector<float>& levels) {
    eachLook(look, [&](Look& one) {
        for (size_t e = 0; e < emitters.size(); ++e) {
            if (levels[e] == 1) continue;
            auto at = std::find_if(one.emitters.begin(), one.emitters.end(),
                                   [&](const EmitterLook& l) { return l.id == emitters[e].id; });
            if (at == one.emitters.end()) {
                one.emitters.push_back({emitters[e].id});
                at = one.emitters.end() - 1;
            }
            at->powerScale *= levels[e];
        }
    });
    return look;
}

bool environmentsDiffer(const Estimate& estimate) {
    return std::any_of(estimate.states.begin(), estimate.states.end(),
                       [](const LightingState& s) { return s.environment != 0; });
}

Look inState(Look look, const Estimate& estimate, size_t state) {
    const std::vector<EmitterCluster>& emitters = estimate.emitters.emitters;
    look = withLevels(std::move(look), emitters, levelsInState(emitters, state));
    if (!environmentsDiffer(estimate)) return look;
    eachLook(look, [&](Look& one) {
        EnvironmentLook& environment = one.environment;
        if (environment.source == EnvironmentLook::Source::recovered && environment.state.empty() &&
            environment.mixState.empty())
            environment.state = estimate.states[state].name;
    });
    return look;
}

std::vector<float> levelsInState(const std::vector<EmitterCluster>& emitters, size_t state) {
    std::vector<float> levels;
    for (const EmitterCluster& e : emitters) levels.push_back(std::max(0.0f, e.levelIn(state)));
    return levels;
}

std::vector<float> levelsBetween(const std::vector<EmitterCluster>& emitters, size_t first, size_t second,
                                 float fraction) {
    std::vector<float> levels = levelsInState(emitters, first);
    const std::vector<float> others = levelsInState(emitters, second);
    for (size_t e = 0; e < levels.size(); ++e) levels[e] += fraction * (others[e] - levels[e]);
    return levels;
}

}  // namespace relamp
