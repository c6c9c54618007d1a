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

/// What a state's environment is. States of which nothing is said have the environment "shared".
struct StateEnvironment {
    std::string state;
    std::string environment;  ///< "shared", "own", "none", or the state whose environment it has
    bool operator==(const StateEnvironment&) const = default;
};

constexpr size_t mostStates = 64;

/// "NAME=PATTERN". Throws Error for anything else.
StatePattern statePatternOf(const std::string& text);

/// "NAME=own", "=none", "=shared" or "=OTHER STATE". Throws Error for anything else.
StateEnvironment stateEnvironmentOf(const std::string& text);

/// A sentence for users whose state turns out to have another environment than the others.
std::string howToSayOwnEnvironment(const std::string& state);

/// Why a state cannot be called so; empty: it can. Names are 1 to 120 bytes without control characters.
std::string faultOfStateName(const std::string& name);

/// Whether the whole name matches, or lies in the folder that a pattern without `*` and `?` names.
bool matchesPattern(const std::string& name, const std::string& pattern);

/// Fills `states` and each frame's `stateIndex`, from the frames' own words or from patterns, of which the last that
/// matches counts. States are in the order of their first photographs. No word and no pattern: no states. Throws Error
/// naming the frame that belongs to no state though others do, or the pattern that matches nothing.
void assignStates(const std::vector<StatePattern>& patterns, CaptureSource& source);

/// Fills `environmentOfState` from what the file says, and against it from `told`. Environments are numbered in the
/// order of their first states. Empty where all states share one. Throws Error naming a state that does not exist, or
/// states that have each other's environment.
void assignEnvironments(const std::vector<StateEnvironment>& told, CaptureSource& source);

}  // namespace relamp
