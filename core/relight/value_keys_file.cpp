// Keys of single values in an edits document.
#include <algorithm>
#include <nlohmann/json.hpp>

#include "base/json_fields.h"
#include "relight/look.h"
#include "relight/value_keys.h"

namespace relamp {
namespace {

using Owner = KeyedValueInfo::Owner;
using Kind = KeyedValueInfo::Kind;

/// As one look or another of the document has it; null: none of them.
const AddedEmitter* addedAnywhere(const Look& look, const std::string& id) {
    const AddedEmitter* found = nullptr;
    eachLook(look, [&](const Look& one) {
        for (const AddedEmitter& e : one.added)
            if (!found && e.id == id) found = &e;
    });
    return found;
}

bool groupAnywhere(const Look& look, const std::string& name) {
    bool found = false;
    eachLook(look, [&](const Look& one) {
        for (const LightGroup& group : one.groups) found = found || group.name == name;
    });
    return found;
}

/// What a position in a document counts from.
DVec3 shiftOf(const KeyedOf& what, const Look& look, const DVec3& origin) {
    if (what.value != KeyedValue::position) return DVec3(0);
    const AddedEmitter* added = addedAnywhere(look, what.of);
    return added && infoOf(added->shape).own() ? origin : DVec3(0);
}

std::string namesOf(bool group, bool light) {
    std::string names;
    for (const KeyedValueInfo& info : keyedValues())
        if (group ? info.owner == Owner::group : light ? info.ofLight() : info.owner == Owner::look)
            names += (names.empty() ? "" : ", ") + std::string(info.name);
    return names;
}

/// A light's `power_scale` is another row than a group's.
KeyedOf whatOf(const Json& entry, const Look& look, const std::string& where) {
    const bool light = entry.contains("light"), group = entry.contains("group");
    if (light && group) throw Error("{}: names a light and a group, expected one of them", where);
    KeyedOf what;
    if (light) what.of = textOf(entry["light"], where + ".light");
    if (group) what.of = textOf(entry["group"], where + ".group");
    const std::string name = textOf(entry.contains("value") ? entry["value"] : Json(), where + ".value").substr(0, 80);
    const KeyedValueInfo* found = nullptr;
    for (const KeyedValueInfo& info : keyedValues())
        if (name == info.name && (group   ? info.owner == Owner::group
                                  : light ? info.ofLight()
                                          : info.owner == Owner::look))
            found = &info;
    if (!found)
        throw Error("{}.value: is {}, expected of {} {}", where, name,
                    group   ? "a group"
                    : light ? "a light"
                            : "no light",
                    namesOf(group, light));
    what.value = found->value;
    if (group && !groupAnywhere(look, what.of)) throw Error("{}.group: {} is no group of the look", where, what.of);
    if (!light) return what;
    const AddedEmitter* added = addedAnywhere(look, what.of);
    const bool wrong = found->owner == Owner::recovered ? added != nullptr
                       : found->owner == Owner::light   ? false
                                                        : added == nullptr;
    if (wrong)
        throw Error("{}.value: {} is a value of {} lights, and {} is none", where, name,
                    found->owner == Owner::recovered ? "recovered" : "added", what.of);
    if ((found->owner == Owner::own && !infoOf(added->shape).own()) ||
        (found->owner == Owner::shaped && !infoOf(added->shape).shapeable()))
        throw Error("{}.value: a {} has no {}", where, infoOf(added->shape).name, name);
    return what;
}

Vec3 valueFromJson(const Json& value, const KeyedValueInfo& info, const std::string& where, const DVec3& shift) {
    if (info.kind == Kind::flag) return Vec3(flagOf(value, where), 0, 0);
    const auto number = [&](const Json& one, const std::string& place, double less) {
        const double x = numberOf(one, place);
        if (!(x >= double(info.least)) || !(x <= double(info.most)))
            throw Error("{}: is {}, expected {} to {}", place, x, info.least, info.most);
        return float(x - less);
    };
    if (info.components == 1) return Vec3(number(value, where, 0), 0, 0);
    if (!value.is_array() || int(value.size()) != info.components)
        throw Error("{}: expected {} numbers", where, info.components);
    Vec3 out(0);
    for (int k = 0; k < info.components; ++k)
        out[k] = number(value[size_t(k)], fmt::format("{}[{}]", where, k), shift[k]);
    return out;
}

std::vector<ValueKey> keysFrom(const Json& list, const KeyedValueInfo& info, const std::string& where,
                               const DVec3& shift) {
    if (!list.is_array() || list.empty()) throw Error("{}: expected a list of keys", where);
    std::vector<ValueKey> keys;
    for (const Json& one : list) {
        const std::string place = fmt::format("{}[{}]", where, keys.size());
        if (!one.is_object()) throw Error("{}: expected an object", place);
        ValueKey key;
        key.frame = keyFrameFromJson(one, place);
        if (!one.contains("value")) throw Error("{}.value: is missing", place);
        key.value = valueFromJson(one["value"], info, place + ".value", shift);
        key.ease = keyEaseFromJson(one, place);
        keys.push_back(key);
    }
    std::sort(keys.begin(), keys.end(), [](const ValueKey& a, const ValueKey& b) { return a.frame < b.frame; });
    for (size_t i = 1; i < keys.size(); ++i)
        if (keys[i].frame == keys[i - 1].frame) throw Error("{}: frame {} has two values", where, keys[i].frame);
    return keys;
}

}  // namespace

int keyFrameFromJson(const Json& key, const std::string& where) {
    const auto frame = key.find("frame");
    if (frame == key.end() || !frame->is_number_integer() || frame->get<int64_t>() < 0 ||
        frame->get<int64_t>() > 100'000'000)
        throw Error("{}.frame: expected a frame number", where);
    return frame->get<int>();
}

KeyEase keyEaseFromJson(const Json& key, const std::string& where) {
    if (!key.contains("ease")) return KeyEase::linear;
    const std::string ease = textOf(key["ease"], where + ".ease");
    const auto name = std::find(std::begin(keyEaseNames), std::end(keyEaseNames), ease);
    if (name == std::end(keyEaseNames))
        throw Error("{}.ease: is {}, expected linear, smooth or hold", where, ease.substr(0, 40));
    return KeyEase(name - std::begin(keyEaseNames));
}

std::vector<ValueCurve> valueKeysFromJson(const Json& document, const Look& look, const DVec3& origin) {
    std::vector<ValueCurve> curves;
    const auto list = document.find("value_keys");
    if (list == document.end()) return curves;
    if (!list->is_array()) throw Error("value_keys: expected a list");
    for (const Json& entry : *list) {
        const std::string where = fmt::format("value_keys[{}]", curves.size());
        if (!entry.is_object()) throw Error("{}: expected an object", where);
        ValueCurve curve;
        curve.what = whatOf(entry, look, where);
        for (const ValueCurve& other : curves)
            if (other.what == curve.what) throw Error("{}: this value has keys already", where);
        curve.keys = keysFrom(entry.contains("keys") ? entry["keys"] : Json(), infoOf(curve.what.value),
                              where + ".keys", shiftOf(curve.what, look, origin));
        curves.push_back(std::move(curve));
    }
    return curves;
}

Json valueKeysToJson(const Look& look, const DVec3& origin) {
    Json list = Json::array();
    for (const ValueCurve& curve : look.curves) {
        const KeyedValueInfo& info = infoOf(curve.what.value);
        const DVec3 shift = shiftOf(curve.what, look, origin);
        Json entry{{"value", info.name}, {"keys", Json::array()}};
        if (info.owner == Owner::group) entry["group"] = curve.what.of;
        else if (info.ofLight()) entry["light"] = curve.what.of;
        for (const ValueKey& key : curve.keys) {
            Json one{{"frame", key.frame}};
            if (info.kind == Kind::flag) one["value"] = key.value.x > 0.5f;
            else if (info.components == 1) one["value"] = key.value.x;
            else
                for (int k = 0; k < info.components; ++k) one["value"].push_back(double(key.value[k]) + shift[k]);
            if (key.ease != KeyEase::linear) one["ease"] = keyEaseNames[int(key.ease)];
            entry["keys"].push_back(std::move(one));
        }
        list.push_back(std::move(entry));
    }
    return list;
}

}  // namespace relamp
