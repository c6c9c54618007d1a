#include "relight/light_group.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "base/json_fields.h"
#include "relight/look.h"

namespace relamp {
namespace {

constexpr double largestGroupScale = 1e30;

template <class Groups>
auto* groupIn(Groups& groups, const std::string& id) {
    for (auto& group : groups)
        if (std::find(group.members.begin(), group.members.end(), id) != group.members.end()) return &group;
    return decltype(&groups.front())(nullptr);
}

Rgb scaleOf(const JsonFields& fields) {
    const Json* value = fields.find("power_scale");
    if (!value) return Rgb(1);
    const std::string where = fields.name("power_scale");
    const DVec3 scale = pointOf(*value, where);
    for (int c = 0; c < 3; ++c)
        if (!(scale[c] >= 0 && scale[c] <= largestGroupScale))
            throw Error("{}[{}]: is {}, expected 0 to {}", where, c, scale[c], largestGroupScale);
    return Rgb(scale);
}

}  // namespace

const LightGroup* groupOf(const std::vector<LightGroup>& groups, const std::string& id) { return groupIn(groups, id); }
LightGroup* groupOf(std::vector<LightGroup>& groups, const std::string& id) { return groupIn(groups, id); }

Rgb groupFactor(const std::vector<LightGroup>& groups, const std::string& id) {
    const LightGroup* group = groupOf(groups, id);
    return !group ? Rgb(1) : group->enabled ? group->powerScale : Rgb(0);
}

void dropMembers(std::vector<LightGroup>& groups, const std::function<bool(const std::string&)>& gone) {
    for (LightGroup& group : groups) std::erase_if(group.members, gone);
    std::erase_if(groups, [](const LightGroup& group) { return group.members.empty(); });
}

std::vector<LightGroup> groupsFromJson(const Json& document) {
    std::vector<LightGroup> groups;
    for (const JsonFields& fields : JsonFields(document).list("groups")) {
        LightGroup group;
        group.name = tidyName(fields.get<std::string>("name"));
        if (group.name.empty()) throw Error("{}: is empty", fields.name("name"));
        for (const LightGroup& other : groups)
            if (other.name == group.name)
                throw Error("{}: {} is the name of two groups", fields.name("name"), group.name);
        const Json& members = fields.need("members");
        if (!members.is_array()) throw Error("{}: expected a list", fields.name("members"));
        for (size_t i = 0; i < members.size(); ++i) {
            const std::string where = fmt::format("{}[{}]", fields.name("members"), i);
            const std::string id = textOf(members[i], where);
            if (groupOf(groups, id) || std::find(group.members.begin(), group.members.end(), id) != group.members.end())
                throw Error("{}: {} is in a group already", where, id);
            group.members.push_back(id);
        }
        group.enabled = fields.get("enabled", true);
        group.powerScale = scaleOf(fields);
        groups.push_back(std::move(group));
    }
    return groups;
}

Json groupsToJson(const std::vector<LightGroup>& groups) {
    Json list = Json::array();
    for (const LightGroup& g : groups)
        list.push_back({{"name", g.name},
                        {"members", g.members},
                        {"enabled", g.enabled},
                        {"power_scale", {g.powerScale.x, g.powerScale.y, g.powerScale.z}}});
    return list;
}

}  // namespace relamp
