#include "relight/look.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/json_fields.h"
#include "base/log.h"
#include "relight/look_keys.h"
#include "relight/shaping_files.h"

namespace relamp {
namespace {

double wideNumberOf(const Json& value, const std::string& where) {
    if (!value.is_number()) throw Error("{}: expected a number", where);
    const double x = value.get<double>();
    if (!(std::abs(x) <= 1e30)) throw Error("{}: is {}, which is too large; expected at most 1e30", where, x);
    return x;
}

/// Metres, or a factor on them: beyond, single precision cannot tell one place from another.
double lengthOf(const Json& value, const std::string& where) {
    const double x = wideNumberOf(value, where);
    if (!(std::abs(x) <= 1e9)) throw Error("{}: is {}, which is too large; expected at most 1e9", where, x);
    return x;
}

float realOf(const Json& value, const std::string& where) { return float(wideNumberOf(value, where)); }

/// Beyond, light leaves what images hold.
float stopsOf(const Json& value, const std::string& where) {
    const double x = wideNumberOf(value, where);
    if (!(std::abs(x) <= 64)) throw Error("{}: is {}, expected -64 to 64 stops", where, x);
    return float(x);
}

Rgb colourOf(const Json& value, const std::string& where) {
    if (!value.is_array() || value.size() != 3) throw Error("{}: expected three numbers", where);
    Rgb c;
    for (int k = 0; k < 3; ++k) {
        c[k] = realOf(value[size_t(k)], fmt::format("{}[{}]", where, k));
        if (c[k] < 0) throw Error("{}[{}]: is {}, expected 0 or more", where, k, c[k]);
    }
    return c;
}

/// What a matrix acts on: places in the world, or a shape about 0 of its own.
enum class ActsOn { world, shape };

/// How far `origin` moves the last column of a matrix that is written for places counted from 0.
DVec3 shiftOf(const DMat4& m, ActsOn on, const DVec3& origin) {
    return (on == ActsOn::world ? glm::dmat3(m) * origin : DVec3(0)) - origin;
}

Mat4 matrixOf(const Json& value, const std::string& where, ActsOn on, const DVec3& origin) {
    if (!value.is_array() || value.size() != 4) throw Error("{}: expected four rows of four numbers", where);
    DMat4 m(1);
    for (int r = 0; r < 4; ++r) {
        if (!value[size_t(r)].is_array() || value[size_t(r)].size() != 4)
            throw Error("{}[{}]: expected four numbers", where, r);
        for (int c = 0; c < 4; ++c)
            m[c][r] = lengthOf(value[size_t(r)][size_t(c)], fmt::format("{}[{}][{}]", where, r, c));
    }
    if (m[0][3] != 0 || m[1][3] != 0 || m[2][3] != 0 || m[3][3] != 1) throw Error("{}[3]: expected 0 0 0 1", where);
    if (!(std::abs(glm::determinant(glm::dmat3(glm::mat3(m)))) > 1e-18)) throw Error("{}: is singular", where);
    if (origin != DVec3(0)) m[3] += glm::dvec4(shiftOf(m, on, origin), 0);
    return Mat4(m);
}

Json matrixToJson(const Mat4& narrow, ActsOn on, const DVec3& origin) {
    DMat4 m(narrow);
    if (origin != DVec3(0)) m[3] -= glm::dvec4(shiftOf(m, on, origin), 0);
    Json rows = Json::array();
    for (int r = 0; r < 4; ++r) rows.push_back({m[0][r], m[1][r], m[2][r], m[3][r]});
    return rows;
}

ActsOn actsOn(EmitterShape shape) { return infoOf(shape).own() ? ActsOn::shape : ActsOn::world; }

const Json& listOf(const Json& document, const char* key) {
    static const Json empty = Json::array();
    const auto at = document.find(key);
    if (at == document.end()) return empty;
    if (!at->is_array()) throw Error("{}: expected a list", key);
    return *at;
}

uint32_t vertexOf(const Json& object, const std::string& where) {
    const auto at = object.find("seed_vertex");
    if (at == object.end() || !at->is_number_unsigned()) throw Error("{}.seed_vertex: expected a vertex number", where);
    const uint64_t seed = at->get<uint64_t>();
    if (seed > 0xffffffffu) throw Error("{}.seed_vertex: {} does not exist", where, seed);
    return uint32_t(seed);
}

EmitterShape shapeOf(const std::string& name, const std::string& where) {
    if (const EmitterShapeInfo* info = emitterShapeNamed(name)) return info->shape;
    const auto shapes = emitterShapes();
    std::string names = shapes.front().name;
    for (size_t i = 1; i < shapes.size(); ++i)
        names += (i + 1 < shapes.size() ? ", " : " or ") + std::string(shapes[i].name);
    throw Error("{}.shape: is {}, expected {}", where, name, names);
}

std::string textOf(const Json& object, const char* key, const std::string& where) {
    const auto at = object.find(key);
    return relamp::textOf(at == object.end() ? Json() : *at, fmt::format("{}.{}", where, key));
}

bool isControl(char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f; }

/// The lighting states of a recovered environment.
void readStates(const Json& object, EnvironmentLook& look) {
    if (object.contains("state")) look.state = textOf(object, "state", "environment");
    if (object.contains("mix_state")) look.mixState = textOf(object, "mix_state", "environment");
    if (!object.contains("mix")) return;
    look.mix = realOf(object["mix"], "environment.mix");
    if (!(look.mix >= 0 && look.mix <= 1)) throw Error("environment.mix: is {}, expected 0 to 1", look.mix);
}

std::string nameOf(const Json& object, const std::string& where) {
    const std::string name = textOf(object, "name", where);
    if (std::any_of(name.begin(), name.end(), isControl)) throw Error("{}.name: has a control character in it", where);
    return tidyName(name);
}

}  // namespace

std::string tidyName(const std::string& given) {
    std::string name = given;
    std::erase_if(name, isControl);
    const size_t from = name.find_first_not_of(' ');
    if (from == std::string::npos) return {};
    std::string tidy = name.substr(from, longestName);
    if (from + longestName < name.size())
        for (size_t end = from + longestName; end > from && (static_cast<unsigned char>(name[end]) & 0xC0) == 0x80;
             --end)
            tidy.pop_back();
    return tidy.erase(tidy.find_last_not_of(' ') + 1);
}

std::vector<std::string> emitterNames(const std::vector<std::string>& recoveredIds, const Look& look) {
    std::vector<std::string> wanted = recoveredIds;
    for (std::string& name : wanted)
        for (const EmitterLook& e : look.emitters)
            if (e.id == name && !e.name.empty()) {
                name = e.name;
                break;
            }
    for (const AddedEmitter& e : look.added) wanted.push_back(e.name.empty() ? e.id : e.name);
    std::vector<std::string> names;
    for (const std::string& name : wanted) {
        std::string own = name;
        for (int n = 2; std::find(names.begin(), names.end(), own) != names.end(); ++n)
            own = fmt::format("{} ({})", name, n);
        names.push_back(own);
    }
    return names;
}

std::vector<std::filesystem::path> filesOf(const Look& look) {
    std::vector<std::filesystem::path> files;
    const auto take = [&](const std::filesystem::path& file) {
        if (!file.empty() && std::find(files.begin(), files.end(), file) == files.end()) files.push_back(file);
    };
    eachLook(look, [&](const Look& one) {
        if (one.environment.source == EnvironmentLook::Source::file) take(one.environment.file);
        for (const AddedEmitter& e : one.added)
            for (const ShapingFile file : shapingFiles) take(e.shaping.*file);
    });
    return files;
}

namespace {

/// What the document holds beside `keys` is taken by each look that does not say otherwise.
std::vector<LookKey> keysFromJson(const Json& document, const std::filesystem::path& folder, const DVec3& origin) {
    Json rest = document;
    rest.erase("keys");
    rest.erase("plate");
    rest.erase("bookmarks");
    rest.erase("value_keys");
    const Json& list = document["keys"];
    if (!list.is_array()) throw Error("keys: expected a list");
    std::vector<LookKey> keys;
    for (const Json& key : list) {
        const std::string where = fmt::format("keys[{}]", keys.size());
        if (!key.is_object()) throw Error("{}: expected an object", where);
        const int frame = keyFrameFromJson(key, where);
        const auto look = key.find("look");
        if (look == key.end() || !look->is_object()) throw Error("{}.look: expected an object", where);
        for (const char* whole : {"plate", "keys", "bookmarks", "value_keys"})
            if (look->contains(whole)) throw Error("{}.look.{}: a key has none of its own", where, whole);
        Json merged = rest;
        merged.update(*look);
        LookKey made{frame, {}, keyEaseFromJson(key, where)};
        withContext(where + ".look", [&] { made.look = lookFromJson(merged, folder, origin); });
        keys.push_back(std::move(made));
    }
    if (keys.empty()) throw Error("keys: is empty, expected a look");
    std::sort(keys.begin(), keys.end(), [](const LookKey& a, const LookKey& b) { return a.frame < b.frame; });
    for (size_t i = 1; i < keys.size(); ++i)
        if (keys[i].frame == keys[i - 1].frame) throw Error("keys: frame {} has two looks", keys[i].frame);
    return keys;
}

}  // namespace

Look lookFromJson(const Json& document, const std::filesystem::path& folder, const DVec3& origin) {
    if (!document.is_object()) throw Error("expected an object");
    if (const auto version = document.find("version");
        version != document.end() && (!version->is_number_integer() || version->get<int>() != 1))
        throw Error("version: is {}, expected 1", dumpJson(*version, -1, BadText::replace));
    Look look;
    if (const auto at = document.find("environment"); at != document.end()) {
        if (!at->is_object()) throw Error("environment: expected an object");
        const std::string source = at->contains("source") ? textOf(*at, "source", "environment")
                                   : at->contains("file") ? "file"
                                                          : "recovered";
        if (source == "recovered") look.environment.source = EnvironmentLook::Source::recovered;
        else if (source == "none") look.environment.source = EnvironmentLook::Source::none;
        else if (source == "file") look.environment.source = EnvironmentLook::Source::file;
        else throw Error("environment.source: is {}, expected recovered, none or file", source);
        if (look.environment.source == EnvironmentLook::Source::file)
            look.environment.file = folder / textOf(*at, "file", "environment");
        readStates(*at, look.environment);
        if (at->contains("yaw_degrees"))
            look.environment.yawDegrees = float(lengthOf((*at)["yaw_degrees"], "environment.yaw_degrees"));
        if (at->contains("exposure_stops"))
            look.environment.exposureStops = stopsOf((*at)["exposure_stops"], "environment.exposure_stops");
        if (at->contains("tint")) look.environment.tint = colourOf((*at)["tint"], "environment.tint");
        if (at->contains("sides")) look.environment.sides = sidesFromJson((*at)["sides"], "environment.sides");
    }
    size_t i = 0;
    for (const Json& e : listOf(document, "emitters")) {
        const std::string where = fmt::format("emitters[{}]", i++);
        if (!e.is_object()) throw Error("{}: expected an object", where);
        EmitterLook emitter;
        emitter.id = textOf(e, "id", where);
        if (e.contains("enabled")) emitter.enabled = flagOf(e["enabled"], where + ".enabled");
        if (e.contains("matrix")) emitter.matrix = matrixOf(e["matrix"], where + ".matrix", ActsOn::world, origin);
        if (e.contains("shadows")) emitter.shadows = flagOf(e["shadows"], where + ".shadows");
        if (e.contains("link")) emitter.link = linkFromJson(e["link"], where + ".link");
        if (e.contains("power_scale")) emitter.powerScale = colourOf(e["power_scale"], where + ".power_scale");
        if (e.contains("name")) emitter.name = nameOf(e, where);
        look.emitters.push_back(emitter);
    }
    i = 0;
    for (const Json& e : listOf(document, "added_emitters")) {
        const std::string where = fmt::format("added_emitters[{}]", i++);
        if (!e.is_object()) throw Error("{}: expected an object", where);
        AddedEmitter emitter;
        emitter.id = textOf(e, "id", where);
        emitter.shape = shapeOf(textOf(e, "shape", where), where);
        const auto geometry = infoOf(emitter.shape).geometry;
        if (geometry == EmitterShapeInfo::Geometry::component) emitter.seedVertex = vertexOf(e, where);
        if (geometry == EmitterShapeInfo::Geometry::emitter) emitter.source = textOf(e, "source", where);
        if (e.contains("enabled")) emitter.enabled = flagOf(e["enabled"], where + ".enabled");
        const Json matrix = e.contains("matrix") ? e["matrix"] : matrixToJson(Mat4(1), ActsOn::world, DVec3(0));
        emitter.matrix = matrixOf(matrix, where + ".matrix", actsOn(emitter.shape), origin);
        if (e.contains("size")) {
            const Json& size = e["size"];
            if (!size.is_array() || size.empty() || size.size() > 2)
                throw Error("{}.size: expected one or two numbers", where);
            emitter.size = Vec2(float(lengthOf(size[0], where + ".size[0]")));
            if (size.size() == 2) emitter.size.y = float(lengthOf(size[1], where + ".size[1]"));
            if (!(emitter.size.x > 0) || !(emitter.size.y > 0)) throw Error("{}.size: expected more than 0", where);
        }
        if (e.contains("shadows")) emitter.shadows = flagOf(e["shadows"], where + ".shadows");
        if (e.contains("link")) emitter.link = linkFromJson(e["link"], where + ".link");
        if (e.contains("radiance")) emitter.radiance = colourOf(e["radiance"], where + ".radiance");
        if (e.contains("shaping")) {
            if (!infoOf(emitter.shape).shapeable())
                throw Error("{}.shaping: a {} has none", where, infoOf(emitter.shape).name);
            emitter.shaping = shapingFromJson(e["shaping"], where + ".shaping", folder);
            if (!infoOf(emitter.shape).flat && (emitter.shaping.doors() || !emitter.shaping.surfaceFile.empty())) {
                logWarning("{}.shaping: a {} has no face for barn doors or an image; passed over", where,
                           infoOf(emitter.shape).name);
                emitter.shaping.surfaceFile.clear();
                for (const BarnDoor& door : barnDoors) emitter.shaping.*door.degrees = 90;
            }
        }
        if (e.contains("name")) emitter.name = nameOf(e, where);
        look.added.push_back(emitter);
    }
    i = 0;
    for (const Json& p : listOf(document, "parts")) {
        const std::string where = fmt::format("parts[{}]", i++);
        PartLook part;
        part.seedVertex = vertexOf(p, where);
        if (p.contains("matrix")) part.matrix = matrixOf(p["matrix"], where + ".matrix", ActsOn::world, origin);
        if (p.contains("attached_to")) part.attachedTo = textOf(p, "attached_to", where);
        look.parts.push_back(part);
    }
    look.groups = groupsFromJson(document);
    if (const auto at = document.find("materials"); at != document.end()) {
        if (!at->is_object()) throw Error("materials: expected an object");
        if (const auto neutral = at->find("neutral"); neutral != at->end())
            look.neutralMaterials = flagOf(*neutral, "materials.neutral");
    }
    if (const auto at = document.find("plate"); at != document.end()) look.plate = plateLookFromJson(*at, folder);
    look.bookmarks = bookmarksFromJson(document, origin);
    if (document.contains("keys")) look.keys = keysFromJson(document, folder, origin);
    look.curves = valueKeysFromJson(document, look, origin);
    return look;
}

Look readLook(const std::filesystem::path& file, const DVec3& origin) {
    const std::string text = readBytes(file, 64 << 20);
    return withContext(file.string(), [&] {
        const Json document = parseJson(text);
        // Of these, what is captured would be taken for the edits that were asked for.
        if (document.is_object() && document.contains("look"))
            throw Error("is a shot or an autosave, expected an edits document, as stands under its \"look\"");
        const Look look = lookFromJson(document, file.parent_path(), origin);
        for (const std::string& key : unknownLookKeys(document)) logWarning("{}: {}; passed over", file.string(), key);
        return look;
    });
}

Json lookToJson(const Look& look, const DVec3& origin) {
    Json document{{"version", 1}};
    const char* sources[] = {"recovered", "none", "file"};
    Json& environment = document["environment"];
    environment["source"] = sources[int(look.environment.source)];
    if (look.environment.source == EnvironmentLook::Source::file) environment["file"] = look.environment.file.string();
    if (!look.environment.state.empty()) environment["state"] = look.environment.state;
    if (!look.environment.mixState.empty()) {
        environment["mix_state"] = look.environment.mixState;
        environment["mix"] = look.environment.mix;
    }
    environment["yaw_degrees"] = look.environment.yawDegrees;
    environment["exposure_stops"] = look.environment.exposureStops;
    environment["tint"] = {look.environment.tint.x, look.environment.tint.y, look.environment.tint.z};
    if (look.environment.sides != evenSides) environment["sides"] = sidesToJson(look.environment.sides);
    document["emitters"] = Json::array();
    for (const EmitterLook& e : look.emitters) {
        document["emitters"].push_back({{"id", e.id},
                                        {"enabled", e.enabled},
                                        {"matrix", matrixToJson(e.matrix, ActsOn::world, origin)},
                                        {"power_scale", {e.powerScale.x, e.powerScale.y, e.powerScale.z}}});
        if (!e.name.empty()) document["emitters"].back()["name"] = e.name;
        if (!e.shadows) document["emitters"].back()["shadows"] = false;
        if (!e.link.everything()) document["emitters"].back()["link"] = linkToJson(e.link);
    }
    document["added_emitters"] = Json::array();
    for (const AddedEmitter& e : look.added) {
        Json added{{"id", e.id},
                   {"shape", infoOf(e.shape).name},
                   {"matrix", matrixToJson(e.matrix, actsOn(e.shape), origin)},
                   {"radiance", {e.radiance.x, e.radiance.y, e.radiance.z}}};
        switch (infoOf(e.shape).geometry) {
            case EmitterShapeInfo::Geometry::own: added["size"] = {e.size.x, e.size.y}; break;
            case EmitterShapeInfo::Geometry::component: added["seed_vertex"] = e.seedVertex; break;
            case EmitterShapeInfo::Geometry::emitter: added["source"] = e.source; break;
        }
        if (!e.shaping.plain()) added["shaping"] = shapingToJson(e.shaping);
        if (!e.enabled) added["enabled"] = false;
        if (!e.shadows) added["shadows"] = false;
        if (!e.link.everything()) added["link"] = linkToJson(e.link);
        if (!e.name.empty()) added["name"] = e.name;
        document["added_emitters"].push_back(std::move(added));
    }
    document["parts"] = Json::array();
    for (const PartLook& p : look.parts) {
        document["parts"].push_back(
            {{"seed_vertex", p.seedVertex}, {"matrix", matrixToJson(p.matrix, ActsOn::world, origin)}});
        if (!p.attachedTo.empty()) document["parts"].back()["attached_to"] = p.attachedTo;
    }
    if (!look.groups.empty()) document["groups"] = groupsToJson(look.groups);
    document["materials"] = {{"neutral", look.neutralMaterials}};
    if (look.plate) document["plate"] = plateLookToJson(*look.plate);
    if (!look.bookmarks.empty()) document["bookmarks"] = bookmarksToJson(look.bookmarks, origin);
    for (const LookKey& key : look.keys) {
        Json one{{"frame", key.frame}, {"look", lookToJson(key.look, origin)}};
        if (key.ease != KeyEase::linear) one["ease"] = keyEaseNames[int(key.ease)];
        document["keys"].push_back(std::move(one));
    }
    if (!look.curves.empty()) document["value_keys"] = valueKeysToJson(look, origin);
    return document;
}

}  // namespace relamp
