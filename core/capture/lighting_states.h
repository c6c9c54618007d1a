// Lighting states: photographs of one scene between which lights were switched. Each photograph belongs to one state,
// by its frame's word or by a pattern that its name matches.
#pragma once
#include <string>
#include <vector>

namespace relamp {

struct CaptureSource;

/// Photographs whose names match the pattern belong to the state.
struct StatePattern {
    std::string name;     ///< of the state
    std::string pattern;  ///< `*` for any characters, `?` for one; without either: a folder, or a photograph's name
    bool operator==(const StatePattern&) const = default;
};

constexpr size_t mostStates = 64;

/// "NAME=PATTERN". Throws Error for anything else.
StatePattern statePatternOf(const std::string& text);

/// Why a state cannot be called so; empty: it can. Names are 1 to 120 bytes without control characters.
std::string faultOfStateName(const std::string& name);

/// Whether the whole name matches, or lies in the folder that a pattern without `*` and `?` names.
bool matchesPattern(const std::string& name, const std::string& pattern);

/// Fills `states` and each frame's `stateIndex`, from the frames' own words or from patterns, of which the last that
/// matches counts. States are in the order of their first photographs. No word and no pattern: no states. Throws Error
/// naming the frame that belongs to no state though others do, or the pattern that matches nothing.
void assignStates(const std::vector<StatePattern>& patterns, CaptureSource& source);

}  // namespace relamp
