// Which objects a light falls on: light linking, an artist's cheat, as a value of the look.
#pragma once
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "scene/scene.h"

namespace relamp {

/// Objects are connected components of the capture's mesh, each named by one of its vertices. A light that is kept from
/// an object does not light it, neither matte nor in gloss. The object casts its shadow all the same, and light that
/// other surfaces pass on still reaches it.
struct LightLink {
    bool only = false;            ///< false: it falls on all but `parts`; true: on these alone
    std::vector<uint32_t> parts;  ///< seed vertices

    bool everything() const { return !only && parts.empty(); }
    bool operator==(const LightLink&) const = default;
};

/// Per component of the capture's mesh 1 where the light falls on it.
using LightReach = std::vector<uint8_t>;

/// Null: it falls on everything. Throws Error "WHERE: part 7 does not exist, the mesh has 5 vertices".
std::shared_ptr<const LightReach> reachOf(const LightLink& link, const Scene& scene, const std::string& where);

/// "link" of docs/interface.md 3: {"except": [...]} or {"only": [...]}; `where` names it in errors. Throws Error naming
/// the field.
LightLink linkFromJson(const nlohmann::json& object, const std::string& where);
nlohmann::json linkToJson(const LightLink& link);

}  // namespace relamp
