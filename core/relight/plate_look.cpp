#include "relight/plate_look.h"

#include <nlohmann/json.hpp>

#include "base/error.h"
#include "base/json_fields.h"

namespace relamp {

PlateLook plateLookFromJson(const Json& plate, const std::filesystem::path& folder) {
    if (!plate.is_object()) throw Error("plate: expected an object");
    const auto text = [&](const char* key, const std::string& otherwise) {
        const auto at = plate.find(key);
        return at == plate.end() ? otherwise : textOf(*at, fmt::format("plate.{}", key));
    };
    const auto file = [&](const char* key) {
        const std::string named = text(key, "");
        return named.empty() ? std::filesystem::path() : (folder / named).lexically_normal();
    };
    PlateLook look;
    look.files = file("files");
    look.cameras = file("camera");
    if (look.files.empty()) throw Error("plate.files: expected the name of a plate");
    if (look.cameras.empty()) throw Error("plate.camera: expected the name of its tracked camera");
    look.lens = file("lens");
    look.matte = file("matte");
    if (const auto offset = plate.find("camera_offset"); offset != plate.end()) {
        if (!offset->is_number_integer() || std::abs(offset->get<double>()) > 1e8)
            throw Error("plate.camera_offset: expected a number of frames");
        look.offset = offset->get<int>();
    }
    look.rotation = text("rotation", look.rotation);
    look.curve = text("curve", look.curve);
    look.match = text("match", look.match);
    const std::string light = text("matte_light", "keep");
    if (light != "keep" && light != "relight")
        throw Error("plate.matte_light: is {}, expected keep or relight", light.substr(0, 40));
    look.relightMatte = light == "relight";
    return look;
}

Json plateLookToJson(const PlateLook& plate) {
    Json document{{"files", plate.files.string()}, {"camera", plate.cameras.string()}};
    if (!plate.lens.empty()) document["lens"] = plate.lens.string();
    if (!plate.matte.empty()) document["matte"] = plate.matte.string();
    if (plate.offset != 0) document["camera_offset"] = plate.offset;
    const PlateLook usual;
    if (plate.rotation != usual.rotation) document["rotation"] = plate.rotation;
    if (plate.curve != usual.curve) document["curve"] = plate.curve;
    if (plate.match != usual.match) document["match"] = plate.match;
    if (plate.relightMatte) document["matte_light"] = "relight";
    return document;
}

}  // namespace relamp
