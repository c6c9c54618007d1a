#include "relight/light_shaping.h"

#include <nlohmann/json.hpp>

#include "base/json_fields.h"

namespace relamp {

LightShaping shapingFromJson(const Json& object, const std::string& where, const std::filesystem::path& folder) {
    if (!object.is_object()) throw Error("{}: expected an object", where);
    const JsonFields fields(object, where);
    LightShaping out;
    const auto within = [&](const char* key, float fallback, float low, float high) {
        const float value = fields.get<float>(key, fallback);
        if (!(value >= low) || value > high)
            throw Error("{}: is {}, expected {} to {}", fields.name(key), value, low, high);
        return value;
    };
    const auto file = [&](const char* key) {
        const std::string name = fields.get<std::string>(key, "");
        return name.empty() ? std::filesystem::path() : folder / name;
    };
    out.coneDegrees = within("cone_degrees", out.coneDegrees, 0.1f, 180);
    out.coneSoftness = within("cone_softness", out.coneSoftness, 0, 1);
    out.focus = within("focus", out.focus, 0, 1000);
    for (const BarnDoor& door : barnDoors) out.*door.degrees = within(door.key, 90, mostShutDoor, 90);
    out.iesFile = file("ies_file");
    out.goboFile = file("gobo_file");
    out.surfaceFile = file("surface_file");
    return out;
}

Json shapingToJson(const LightShaping& shaping) {
    const LightShaping plain;
    Json out = Json::object();
    if (shaping.coneDegrees != plain.coneDegrees) out["cone_degrees"] = shaping.coneDegrees;
    if (shaping.coneSoftness != plain.coneSoftness) out["cone_softness"] = shaping.coneSoftness;
    if (shaping.focus != plain.focus) out["focus"] = shaping.focus;
    for (const BarnDoor& door : barnDoors)
        if (shaping.*door.degrees < 90) out[door.key] = shaping.*door.degrees;
    if (!shaping.iesFile.empty()) out["ies_file"] = shaping.iesFile.string();
    if (!shaping.goboFile.empty()) out["gobo_file"] = shaping.goboFile.string();
    if (!shaping.surfaceFile.empty()) out["surface_file"] = shaping.surfaceFile.string();
    return out;
}

LightShaping blendShapings(const LightShaping& a, const LightShaping& b, float t) {
    LightShaping out = a;
    out.coneDegrees += t * (b.coneDegrees - a.coneDegrees);
    out.coneSoftness += t * (b.coneSoftness - a.coneSoftness);
    out.focus += t * (b.focus - a.focus);
    for (const BarnDoor& door : barnDoors) out.*door.degrees += t * (b.*door.degrees - a.*door.degrees);
    return out;
}

}  // namespace relamp
