#include "edit/state_edits.h"

#include <algorithm>
#include <cmath>

#include "relight/state_look.h"

namespace relamp {

void showLevels(Look& look, const Estimate& estimate, const std::vector<float>& levels) {
    const std::vector<EmitterCluster>& emitters = estimate.emitters.emitters;
    for (size_t e = 0; e < emitters.size() && e < levels.size(); ++e) {
        auto at = std::find_if(look.emitters.begin(), look.emitters.end(),
                               [&](const EmitterLook& l) { return l.id == emitters[e].id; });
        if (at == look.emitters.end()) {
            if (levels[e] == 1) continue;
            look.emitters.push_back({emitters[e].id});
            at = look.emitters.end() - 1;
        }
        // One that is off can be switched on again.
        at->enabled = levels[e] > 0;
        at->powerScale = Rgb(levels[e] > 0 ? levels[e] : 1.0f);
    }
    // What stays as recovered need not be said.
    std::erase_if(look.emitters, [&](const EmitterLook& l) {
        const bool recovered =
            std::any_of(emitters.begin(), emitters.end(), [&](const EmitterCluster& e) { return e.id == l.id; });
        return recovered && l == EmitterLook{l.id};
    });
}

std::vector<float> shownLevels(const Look& look, const Estimate& estimate) {
    std::vector<float> levels;
    for (const EmitterCluster& e : estimate.emitters.emitters) {
        levels.push_back(1);
        for (const EmitterLook& l : look.emitters)
            if (l.id == e.id) levels.back() = l.enabled ? luminance(l.powerScale) : 0.0f;
    }
    return levels;
}

std::optional<size_t> shownState(const Look& look, const Estimate& estimate) {
    const std::vector<float> shown = shownLevels(look, estimate);
    for (size_t s = 0; s < estimate.states.size(); ++s) {
        const std::vector<float> levels = levelsInState(estimate.emitters.emitters, s);
        bool same = true;
        for (size_t e = 0; e < shown.size(); ++e) same &= std::abs(shown[e] - levels[e]) < 1e-4f;
        if (same) return s;
    }
    return {};
}

float shownMix(const Look& look, const Estimate& estimate, size_t first, size_t second) {
    const std::vector<EmitterCluster>& emitters = estimate.emitters.emitters;
    const std::vector<float> shown = shownLevels(look, estimate), from = levelsInState(emitters, first),
                             to = levelsInState(emitters, second);
    float along = 0, length = 0;
    for (size_t e = 0; e < shown.size(); ++e) {
        along += (shown[e] - from[e]) * (to[e] - from[e]);
        length += (to[e] - from[e]) * (to[e] - from[e]);
    }
    return length > 0 ? std::clamp(along / length, 0.0f, 1.0f) : 0.0f;
}

}  // namespace relamp
