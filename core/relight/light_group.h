// Lights that an artist handles as one: a name, and what it does to the light of each of its members.
#pragma once
#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "base/math.h"

namespace relamp {

struct LightGroup {
    std::string name;                    ///< no two groups of a look are called alike
    std::vector<std::string> members{};  ///< ids of emitters; each is in one group at most
    bool enabled = true;
    Rgb powerScale{1};  ///< multiplies the radiance of every member
    bool operator==(const LightGroup&) const = default;
};

/// The group that holds the emitter; null: none.
const LightGroup* groupOf(const std::vector<LightGroup>& groups, const std::string& id);
LightGroup* groupOf(std::vector<LightGroup>& groups, const std::string& id);
/// What the emitter's radiance is multiplied by: 0 where its group is off, 1 where it has none.
Rgb groupFactor(const std::vector<LightGroup>& groups, const std::string& id);
/// Takes members out, and groups that have none left.
void dropMembers(std::vector<LightGroup>& groups, const std::function<bool(const std::string&)>& gone);

/// `groups` of an edits document. Throws Error naming the field.
std::vector<LightGroup> groupsFromJson(const nlohmann::json& document);
nlohmann::json groupsToJson(const std::vector<LightGroup>& groups);

}  // namespace relamp
