// Names that tell the things of a look's list apart.
#pragma once
#include <algorithm>
#include <string>
#include <vector>

#include "base/error.h"
#include "relight/look.h"

namespace relamp {

/// The one of this name in a list of things that have one, constant as the list is; null where there is none.
template <class List>
auto* namedIn(List& things, const std::string& name) {
    const auto at = std::find_if(things.begin(), things.end(), [&](const auto& one) { return one.name == name; });
    return at == things.end() ? nullptr : &*at;
}

/// `wanted`, with " (2)", " (3)", ... where the list has that name.
template <class Thing>
std::string freeName(std::vector<Thing>& things, const std::string& wanted) {
    std::string name = wanted;
    for (int n = 2; namedIn(things, name); ++n) name = fmt::format("{} ({})", wanted, n);
    return name;
}

/// The thing gets the name wanted, tidied (tidyName) and free, unless that is empty or its own. The name it has then.
template <class Thing>
std::string renameIn(std::vector<Thing>& things, const std::string& name, const std::string& wanted) {
    const std::string tidy = tidyName(wanted);
    Thing* thing = namedIn(things, name);
    if (!thing || tidy.empty() || tidy == name) return name;
    const std::string free = freeName(things, tidy);
    thing->name = free;
    return free;
}

/// "Group 1", "Group 2", ...: the first that the list does not have.
template <class Thing>
std::string nextName(std::vector<Thing>& things, const std::string& word) {
    for (int n = 1;; ++n)
        if (std::string next = fmt::format("{} {}", word, n); !namedIn(things, next)) return next;
}

}  // namespace relamp
