#include "edit/group_edits.h"

#include <algorithm>

#include "edit/free_name.h"

namespace relamp {

std::string groupLights(Look& look, const std::vector<std::string>& ids, const std::string& name) {
    if (ids.empty()) return {};
    dropMembers(look.groups, [&](const std::string& id) { return std::find(ids.begin(), ids.end(), id) != ids.end(); });
    LightGroup group;
    group.name = tidyName(name);
    group.name = group.name.empty() ? nextName(look.groups, "Group") : freeName(look.groups, group.name);
    group.members = ids;
    look.groups.push_back(group);
    return group.name;
}

void dissolveGroup(Look& look, const std::string& name) {
    std::erase_if(look.groups, [&](const LightGroup& group) { return group.name == name; });
}

std::string renameGroup(Look& look, const std::string& name, const std::string& wanted) {
    return renameIn(look.groups, name, wanted);
}

void changeGroup(Look& look, const std::string& name, const std::function<void(LightGroup&)>& change) {
    if (LightGroup* group = namedIn(look.groups, name)) change(*group);
}

void joinGroupOf(Look& look, const std::string& id, const std::string& newcomer) {
    if (LightGroup* group = groupOf(look.groups, id)) group->members.push_back(newcomer);
}

}  // namespace relamp
