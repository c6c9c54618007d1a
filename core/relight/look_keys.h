#pragma once
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "base/json_fields.h"

namespace relamp {

/// The keys of an edits document that no look has, each with its place and the keys that there are: a misspelt key
/// changes nothing. Values are not examined.
std::vector<std::string> unknownLookKeys(const Json& document);

}  // namespace relamp
