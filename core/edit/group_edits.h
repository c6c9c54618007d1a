// What an artist does to groups of lights, as functions on the look.
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "relight/look.h"

namespace relamp {

/// These lights become a group; they leave the groups they were in. An empty `name`: "Group 1", ... The name it got.
std::string groupLights(Look& look, const std::vector<std::string>& ids, const std::string& name = {});
/// Its lights are single again, and shine with their own light alone.
void dissolveGroup(Look& look, const std::string& name);
/// Tidied (tidyName), and told apart from other groups by " (2)"; an empty name changes nothing. The name it got.
std::string renameGroup(Look& look, const std::string& name, const std::string& wanted);
/// Nothing happens where there is none of this name.
void changeGroup(Look& look, const std::string& name, const std::function<void(LightGroup&)>& change);
/// A light that was made from another joins its group.
void joinGroupOf(Look& look, const std::string& id, const std::string& newcomer);

}  // namespace relamp
