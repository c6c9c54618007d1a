#include "relight/look_keys.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "base/error.h"

namespace relamp {
namespace {

struct KeyTable {
    struct Inner {
        const char* key;
        const KeyTable* table;
    };
    std::vector<const char*> plain;
    std::vector<Inner> inner;  ///< objects, or lists of objects

    std::string names() const {
        std::string all;
        for (const char* key : plain) all += fmt::format("{}{}", all.empty() ? "" : ", ", key);
        for (const Inner& one : inner) all += fmt::format("{}{}", all.empty() ? "" : ", ", one.key);
        return all;
    }
};

const KeyTable& lookTable() {
    static const KeyTable environment{
        {"source", "file", "state", "mix_state", "mix", "yaw_degrees", "exposure_stops", "tint", "sides"}, {}};
    static const KeyTable link{{"only", "except"}, {}};
    static const KeyTable emitter{{"id", "enabled", "matrix", "shadows", "power_scale", "name"}, {{"link", &link}}};
    static const KeyTable shaping{{"cone_degrees", "cone_softness", "focus", "left_door_degrees", "right_door_degrees",
                                   "top_door_degrees", "bottom_door_degrees", "ies_file", "gobo_file", "surface_file"},
                                  {}};
    static const KeyTable added{
        {"id", "shape", "matrix", "size", "seed_vertex", "source", "radiance", "enabled", "shadows", "name"},
        {{"link", &link}, {"shaping", &shaping}}};
    static const KeyTable part{{"seed_vertex", "matrix", "attached_to"}, {}};
    static const KeyTable group{{"name", "members", "enabled", "power_scale"}, {}};
    static const KeyTable materials{{"neutral"}, {}};
    static const KeyTable whole{{"version"},
                                {{"environment", &environment},
                                 {"emitters", &emitter},
                                 {"added_emitters", &added},
                                 {"parts", &part},
                                 {"groups", &group},
                                 {"materials", &materials}}};
    return whole;
}

/// Also with `keys`, whose looks have none of their own.
const KeyTable& documentTable() {
    static const KeyTable key{{"frame", "ease"}, {{"look", &lookTable()}}};
    static const KeyTable plate{
        {"files", "files_absolute", "camera", "camera_absolute", "lens", "lens_absolute", "matte", "matte_absolute",
         "camera_offset", "rotation", "curve", "match", "matte_light"},
        {}};
    static const KeyTable bookmark{
        {"name", "target", "distance", "azimuth_degrees", "elevation_degrees", "vertical_fov_degrees", "orthographic"},
        {}};
    static const KeyTable valueKey{{"frame", "value", "ease"}, {}};
    static const KeyTable curve{{"value", "light", "group"}, {{"keys", &valueKey}}};
    static const KeyTable whole = [] {
        KeyTable table = lookTable();
        table.inner.push_back({"keys", &key});
        table.inner.push_back({"plate", &plate});
        table.inner.push_back({"bookmarks", &bookmark});
        table.inner.push_back({"value_keys", &curve});
        return table;
    }();
    return whole;
}

void collect(const Json& object, const KeyTable& table, const std::string& where, std::vector<std::string>& found) {
    if (!object.is_object()) return;
    for (const auto& [key, value] : object.items()) {
        const std::string place = where.empty() ? key : where + "." + key;
        const auto inner = std::find_if(table.inner.begin(), table.inner.end(),
                                        [&name = key](const KeyTable::Inner& one) { return name == one.key; });
        if (inner != table.inner.end()) {
            if (!value.is_array()) collect(value, *inner->table, place, found);
            else
                for (size_t i = 0; i < value.size(); ++i)
                    collect(value[i], *inner->table, fmt::format("{}[{}]", place, i), found);
        } else if (std::find(table.plain.begin(), table.plain.end(), key) == table.plain.end()) {
            found.push_back(fmt::format("{}: is no key here (there are {})", place.substr(0, 200), table.names()));
        }
    }
}

}  // namespace

std::vector<std::string> unknownLookKeys(const Json& document) {
    std::vector<std::string> found;
    collect(document, documentTable(), "", found);
    return found;
}

}  // namespace relamp
