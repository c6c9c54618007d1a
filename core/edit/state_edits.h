// Lighting states of the photographs as edits: emitters on and off as they were, or between two states.
#pragma once
#include <optional>
#include <vector>

#include "relight/look.h"
#include "solve/estimate.h"

namespace relamp {

/// Switches and powers of the recovered emitters become those of `levels`, in parts of what each sends where it is
/// brightest; colours of theirs go back to what was recovered. Places, names, added lights and the environment stay.
void showLevels(Look& look, const Estimate& estimate, const std::vector<float>& levels);

/// The levels that a look shows; a colour counts by its luminance.
std::vector<float> shownLevels(const Look& look, const Estimate& estimate);

/// The first state whose levels a look shows exactly; none: it was edited, or there are no states.
std::optional<size_t> shownState(const Look& look, const Estimate& estimate);

/// Switches, powers and, where states differ in it, the environment become those of a state; none: of a mix of two,
/// `fraction` of the second, 0 to 1. Turn, exposure and tint of the environment stay.
void showState(Look& look, const Estimate& estimate, size_t state);
void showMix(Look& look, const Estimate& estimate, size_t first, size_t second, float fraction);

/// Whether a look's environment is the recovered one of a state, turned or not.
bool showsEnvironment(const EnvironmentLook& look, const Estimate& estimate, size_t state);

/// How far a look is from state `first` to state `second`, 0 to 1: the mix that is nearest to what it shows.
float shownMix(const Look& look, const Estimate& estimate, size_t first, size_t second);

}  // namespace relamp
