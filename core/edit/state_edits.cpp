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

namespace {

/// A name of none is that of the estimate's own environment.
int environmentNamed(const std::string& name, const Estimate& estimate) {
    for (const LightingState& state : estimate.states)
        if (state.name == name) return state.environment;
    return 0;
}

/// The environment of a state; the name is left out where it says nothing new.
void takeEnvironment(EnvironmentLook& look, const Estimate& estimate, size_t state) {
    if (!environmentsDiffer(estimate)) return;
    look.source = EnvironmentLook::Source::recovered;
    look.state = estimate.states[state].environment == 0 ? "" : estimate.states[state].name;
    look.mixState.clear();
    look.mix = 0;
}

}  // namespace

bool showsEnvironment(const EnvironmentLook& look, const Estimate& estimate, size_t state) {
    if (!environmentsDiffer(estimate)) return true;
    return look.source == EnvironmentLook::Source::recovered && (look.mixState.empty() || look.mix == 0) &&
           environmentNamed(look.state, estimate) == estimate.states[state].environment;
}

void showState(Look& look, const Estimate& estimate, size_t state) {
    showLevels(look, estimate, levelsInState(estimate.emitters.emitters, state));
    takeEnvironment(look.environment, estimate, state);
}

void showMix(Look& look, const Estimate& estimate, size_t first, size_t second, float fraction) {
    showLevels(look, estimate, levelsBetween(estimate.emitters.emitters, first, second, fraction));
    const bool turned = fraction >= 1;
    takeEnvironment(look.environment, estimate, turned ? second : first);
    if (turned || !(fraction > 0) || estimate.states[first].environment == estimate.states[second].environment) return;
    look.environment.mixState = estimate.states[second].name;
    look.environment.mix = fraction;
}

std::optional<size_t> shownState(const Look& look, const Estimate& estimate) {
    const std::vector<float> shown = shownLevels(look, estimate);
    for (size_t s = 0; s < estimate.states.size(); ++s) {
        const std::vector<float> levels = levelsInState(estimate.emitters.emitters, s);
        bool same = true;
        for (size_t e = 0; e < shown.size(); ++e) same &= std::abs(shown[e] - levels[e]) < 1e-4f;
        if (same && showsEnvironment(look.environment, estimate, s)) return s;
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
    if (length > 0) return std::clamp(along / length, 0.0f, 1.0f);
    const EnvironmentLook& environment = look.environment;
    if (estimate.states[first].environment == estimate.states[second].environment) return 0;
    if (!environment.mixState.empty())
        return environment.mixState == estimate.states[second].name ? environment.mix : 0;
    return environmentNamed(environment.state, estimate) == estimate.states[second].environment ? 1.0f : 0.0f;
}

}  // namespace relamp
