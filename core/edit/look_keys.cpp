#include "edit/look_keys.h"

#include <algorithm>

namespace relamp {
namespace {

Look withoutKeys(Look look) {
    look.keys.clear();
    look.plate.reset();
    look.bookmarks.clear();
    return look;
}

template <class Named>
const Named* named(const std::vector<Named>& list, const std::string& id) {
    const auto at = std::find_if(list.begin(), list.end(), [&](const Named& one) { return one.id == id; });
    return at == list.end() ? nullptr : &*at;
}

/// Lights that came and went, and new names, in another key.
void carryOver(const Look& before, const Look& after, Look& key) {
    for (const AddedEmitter& light : after.added)
        if (!named(before.added, light.id) && !named(key.added, light.id)) key.added.push_back(light);
    std::erase_if(key.added, [&](const AddedEmitter& light) {
        return named(before.added, light.id) && !named(after.added, light.id);
    });
    for (AddedEmitter& light : key.added)
        if (const AddedEmitter* now = named(after.added, light.id)) light.name = now->name;
    for (const EmitterLook& light : after.emitters) {
        const EmitterLook* was = named(before.emitters, light.id);
        if (light.name == (was ? was->name : std::string())) continue;
        const auto there = std::find_if(key.emitters.begin(), key.emitters.end(),
                                        [&](const EmitterLook& one) { return one.id == light.id; });
        if (there != key.emitters.end()) there->name = light.name;
        else {
            EmitterLook recovered;
            recovered.id = light.id;
            recovered.name = light.name;
            key.emitters.push_back(recovered);
        }
    }
}

/// Which groups there are, and of what; each keeps its own light in the key, also under a new name.
void carryGroups(const Look& before, const Look& after, Look& key) {
    if (before.groups == after.groups) return;
    std::vector<LightGroup> groups = after.groups;
    for (LightGroup& group : groups) {
        const auto was = std::find_if(before.groups.begin(), before.groups.end(), [&](const LightGroup& g) {
            return g.name == group.name || g.members == group.members;
        });
        if (was == before.groups.end()) continue;
        for (const LightGroup& own : key.groups)
            if (own.name == was->name) group.enabled = own.enabled, group.powerScale = own.powerScale;
    }
    key.groups = std::move(groups);
}

}  // namespace

int keyAt(const Look& look, int frame) {
    for (size_t i = 0; i < look.keys.size(); ++i)
        if (look.keys[i].frame == frame) return int(i);
    return -1;
}

void setKey(Look& look, int frame) {
    if (const int at = keyAt(look, frame); at >= 0) {
        look.keys[size_t(at)].look = withoutKeys(look);
        return;
    }
    LookKey key{frame, withoutKeys(look), KeyEase::linear};
    const auto after =
        std::find_if(look.keys.begin(), look.keys.end(), [&](const LookKey& k) { return k.frame > frame; });
    if (after != look.keys.begin()) key.ease = std::prev(after)->ease;
    look.keys.insert(after, std::move(key));
}

void deleteKey(Look& look, int frame) {
    std::erase_if(look.keys, [&](const LookKey& key) { return key.frame == frame; });
}

void moveKey(Look& look, int from, int to) {
    const int at = keyAt(look, from);
    if (at < 0 || from == to) return;
    LookKey key = look.keys[size_t(at)];
    deleteKey(look, from);
    deleteKey(look, to);
    key.frame = to;
    const auto after = std::find_if(look.keys.begin(), look.keys.end(), [&](const LookKey& k) { return k.frame > to; });
    look.keys.insert(after, std::move(key));
}

void easeKey(Look& look, int frame, KeyEase ease) {
    if (const int at = keyAt(look, frame); at >= 0) look.keys[size_t(at)].ease = ease;
}

void keyEdit(const Look& before, Look& look, int frame) {
    if (look.keys.empty() || look.keys != before.keys || withoutKeys(look) == withoutKeys(before)) return;
    for (LookKey& key : look.keys) {
        carryOver(before, look, key.look);
        carryGroups(before, look, key.look);
    }
    setKey(look, frame);
}

}  // namespace relamp
