#include "relight/light_link.h"

#include <nlohmann/json.hpp>

#include "base/error.h"
#include "base/json_fields.h"

namespace relamp {

std::shared_ptr<const LightReach> reachOf(const LightLink& link, const Scene& scene, const std::string& where) {
    if (link.everything()) return nullptr;
    LightReach reach(scene.components, link.only ? 0 : 1);
    for (const uint32_t seed : link.parts) {
        if (seed >= scene.mesh.vertexCount())
            throw Error("{}: part {} does not exist, the mesh has {} vertices", where, seed, scene.mesh.vertexCount());
        reach[scene.component[seed]] = link.only ? 1 : 0;
    }
    return std::make_shared<const LightReach>(std::move(reach));
}

LightLink linkFromJson(const Json& object, const std::string& where) {
    if (!object.is_object()) throw Error("{}: expected an object", where);
    if (object.contains("only") == object.contains("except"))
        throw Error("{}: expected either except or only, a list of vertex numbers", where);
    LightLink link;
    link.only = object.contains("only");
    const char* key = link.only ? "only" : "except";
    const Json& list = object[key];
    if (!list.is_array() || (link.only && list.empty()))
        throw Error("{}.{}: expected {}", where, key, link.only ? "one vertex number or more" : "vertex numbers");
    for (const Json& vertex : list) {
        if (!vertex.is_number_integer() || vertex.get<double>() < 0 || vertex.get<double>() > double(0xffffffffu))
            throw Error("{}.{}[{}]: expected a vertex number", where, key, link.parts.size());
        link.parts.push_back(vertex.get<uint32_t>());
    }
    return link;
}

Json linkToJson(const LightLink& link) { return {{link.only ? "only" : "except", link.parts}}; }

}  // namespace relamp
