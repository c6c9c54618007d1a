#include "edit/group_edits.h"

#include <algorithm>

#include "base/error.h"

namespace relamp {
namespace {

LightGroup* groupNamed(Look& look, const std::string& name) {
    for (LightGroup& group : look.groups)
        if (group.name == name) return &group;
    return nullptr;
}

std::string freeGroupName(Look& look, const std::string& wanted) {
    std::string name = wanted;
    for (int n = 2; groupNamed(look, name); ++n) name = fmt::format("{} ({})", wanted, n);
    return name;
}

}  // namespace

std::string groupLights(Look& look, const std::vector<std::string>& ids, const std::string& name) {
    if (ids.empty()) return {};
    dropMembers(look.groups, [&](const std::string& id) { return std::find(ids.begin(), ids.end(), id) != ids.end(); });
    LightGroup group;
    group.name = tidyName(name);
    for (int n = 1; group.name.empty(); ++n)
        if (const std::string next = fmt::format("Group {}", n); !groupNamed(look, next)) group.name = next;
    group.name = freeGroupName(look, group.name);
    group.members = ids;
    look.groups.push_back(group);
    return group.name;
}

void dissolveGroup(Look& look, const std::string& name) {
    std::erase_if(look.groups, [&](const LightGroup& group) { return group.name == name; });
}

std::string renameGroup(Look& look, const std::string& name, const std::string& wanted) {
    const std::string tidy = tidyName(wanted);
    LightGroup* group = groupNamed(look, name);
    if (!group || tidy.empty() || tidy == name) return name;
    const std::string free = freeGroupName(look, tidy);
    group->name = free;
    return free;
}

void changeGroup(Look& look, const std::string& name, const std::function<void(LightGroup&)>& change) {
    if (LightGroup* group = groupNamed(look, name)) change(*group);
}

void joinGroupOf(Look& look, const std::string& id, const std::string& newcomer) {
    if (LightGroup* group = groupOf(look.groups, id)) group->members.push_back(newcomer);
}

}  // namespace relamp
