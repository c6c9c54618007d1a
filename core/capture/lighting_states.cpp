#include "capture/lighting_states.h"

#include <algorithm>
#include <array>
#include <utility>

#include "base/error.h"
#include "base/printable.h"
#include "capture/capture_source.h"

namespace relamp {

std::string faultOfStateName(const std::string& name) {
    constexpr size_t longest = 120;
    if (name.empty()) return "is empty, expected the name of a lighting state";
    if (name.size() > longest) return fmt::format("has {} bytes, expected at most {}", name.size(), longest);
    if (printable(name) != name) return "has a control character in it";
    return "";
}

StatePattern statePatternOf(const std::string& text) {
    const size_t at = text.find('=');
    if (at == std::string::npos || at + 1 == text.size())
        throw Error("--state {}: expected NAME=PATTERN, for example \"lamp off=images/off/*\"", printable(text));
    StatePattern result{text.substr(0, at), text.substr(at + 1)};
    if (const std::string fault = faultOfStateName(result.name); !fault.empty())
        throw Error("--state {}: the name {}", printable(text), fault);
    return result;
}

StateEnvironment stateEnvironmentOf(const std::string& text) {
    const size_t at = text.rfind('=');
    if (at == std::string::npos || at == 0 || at + 1 == text.size())
        throw Error("--state-environment {}: expected NAME=own, NAME=none, NAME=shared or NAME=OTHER STATE",
                    printable(text));
    return {text.substr(0, at), text.substr(at + 1)};
}

std::string howToSayOwnEnvironment(const std::string& state) {
    return fmt::format(
        "If {0} has another environment, say so: \"states\": {{\"{0}\": {{\"environment\": \"own\"}}}} in "
        "transforms.json, or --state-environment \"{0}=own\" (=none: no distant light)",
        state);
}

bool matchesPattern(const std::string& name, const std::string& pattern) {
    if (pattern.find_first_of("*?") == std::string::npos) {
        if (name == pattern) return true;
        const std::string folder = pattern.ends_with('/') ? pattern : pattern + '/';
        return name.starts_with(folder);
    }
    // Greedy: only the last star ever has to be lengthened.
    size_t n = 0, p = 0, star = std::string::npos, after = 0;
    while (n < name.size()) {
        if (p < pattern.size() && (pattern[p] == '?' || (pattern[p] == name[n] && pattern[p] != '*'))) {
            ++n, ++p;
        } else if (p < pattern.size() && pattern[p] == '*') {
            star = p++;
            after = n;
        } else if (star != std::string::npos) {
            p = star + 1;
            n = ++after;
        } else {
            return false;
        }
    }
    while (p < pattern.size() && pattern[p] == '*') ++p;
    return p == pattern.size();
}

void assignStates(const std::vector<StatePattern>& patterns, CaptureSource& source) {
    std::vector<size_t> matched(patterns.size(), 0);
    for (FrameSource& frame : source.frames)
        for (size_t k = 0; k < patterns.size(); ++k)
            if (matchesPattern(frame.name, patterns[k].pattern)) {
                frame.state = patterns[k].name;
                ++matched[k];
            }
    for (size_t k = 0; k < patterns.size(); ++k)
        if (matched[k] == 0)
            throw Error("--state {}={}: no photograph's name matches, the first is {}", patterns[k].name,
                        printable(patterns[k].pattern), printable(source.frames[0].name));
    source.states.clear();
    for (const FrameSource& frame : source.frames)
        if (!frame.state.empty() &&
            std::find(source.states.begin(), source.states.end(), frame.state) == source.states.end())
            source.states.push_back(frame.state);
    if (source.states.empty()) return;
    if (source.states.size() > mostStates)
        throw Error("{}: names {} lighting states, expected at most {}", source.where, source.states.size(),
                    mostStates);
    for (FrameSource& frame : source.frames) {
        const auto at = std::find(source.states.begin(), source.states.end(), frame.state);
        if (at == source.states.end())
            throw Error("{}: state is missing, though other frames name one ({} is the first)", frame.where,
                        source.states[0]);
        frame.stateIndex = uint32_t(at - source.states.begin());
    }
}

namespace {

constexpr int noEnvironment = -1;

/// The state whose environment state `s` has, by what was said last of each; itself: its own, -1: none.
int ownerOf(int s, const std::vector<std::string>& states, const std::vector<std::string>& said) {
    int shared = noEnvironment;  // the first that shares
    for (size_t k = said.size(); k-- > 0;)
        if (said[k] == "shared") shared = int(k);
    for (size_t steps = 0; steps <= states.size(); ++steps) {
        const std::string& word = said[size_t(s)];
        if (word == "none") return noEnvironment;
        if (word == "own") return s;
        if (word == "shared") return shared;
        const auto at = std::find(states.begin(), states.end(), word);
        if (at == states.end())
            throw Error("the environment of state {} is {}, expected shared, own, none or another state",
                        printable(states[size_t(s)]), printable(word).substr(0, 80));
        s = int(at - states.begin());
    }
    throw Error("the environment of state {} is that of a state that has its environment",
                printable(states[size_t(s)]));
}

}  // namespace

void assignEnvironments(const std::vector<StateEnvironment>& told, CaptureSource& source) {
    source.environmentOfState.clear();
    const std::vector<std::string>& states = source.states;
    std::vector<std::string> said(states.size(), "shared");
    // States that --state names anew are not those of the file.
    for (const auto* list : std::array{&std::as_const(source.environments), &told})
        for (const StateEnvironment& one : *list) {
            const auto at = std::find(states.begin(), states.end(), one.state);
            if (at == states.end() && list != &told) continue;
            if (at == states.end())
                throw Error("--state-environment {}={}: no photograph is of this state", printable(one.state),
                            printable(one.environment));
            said[size_t(at - states.begin())] = one.environment;
        }
    std::vector<int> owners, environments;
    for (size_t s = 0; s < states.size(); ++s) {
        const int owner = withContext(source.where, [&] { return ownerOf(int(s), states, said); });
        const auto at = std::find(owners.begin(), owners.end(), owner);
        environments.push_back(owner == noEnvironment ? noEnvironment : int(at - owners.begin()));
        if (owner != noEnvironment && at == owners.end()) owners.push_back(owner);
    }
    if (!environments.empty() && owners.empty())
        throw Error("{}: no lighting state has an environment, expected one at least", source.where);
    if (owners.size() > 1 || std::find(environments.begin(), environments.end(), noEnvironment) != environments.end())
        source.environmentOfState = std::move(environments);
}

}  // namespace relamp
