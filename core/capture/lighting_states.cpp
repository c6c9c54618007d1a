#include "capture/lighting_states.h"

#include <algorithm>

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

}  // namespace relamp
