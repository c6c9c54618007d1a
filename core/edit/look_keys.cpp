#include "edit/look_keys.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "edit/value_key_edits.h"

namespace relamp {
namespace {

Look withoutKeys(Look look) {
    look.keys.clear();
    look.curves.clear();
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

/// A movement of a light that its keys of values say, taken back. Rounding must not look like an edit.
void takeBackMoves(const Look& before, Look& look, const std::string& id, const LookPivots& pivots) {
    const auto near = [](const Mat4& a, const Mat4& b) {
        float most = 0, size = 1;
        for (int c = 0; c < 4; ++c)
            for (int r = 0; r < 4; ++r)
                most = std::max(most, std::abs(a[c][r] - b[c][r])), size = std::max(size, std::abs(b[c][r]));
        return most < 1e-4f * size;
    };
    for (const ValueCurve& curve : before.curves)
        if (curve.what.of == id && curve.what.value <= KeyedValue::scale)
            if (const auto was = valueOf(before, curve.what, pivots)) setValue(look, curve.what, *was, pivots);
    for (EmitterLook& light : look.emitters)
        if (light.id == id)
            if (const EmitterLook* was = named(before.emitters, id); near(light.matrix, was ? was->matrix : Mat4(1)))
                light.matrix = was ? was->matrix : Mat4(1);
    for (AddedEmitter& light : look.added)
        if (light.id == id)
            if (const AddedEmitter* was = named(before.added, id); was && near(light.matrix, was->matrix))
                light.matrix = was->matrix;
    for (PartLook& part : look.parts)
        if (part.attachedTo == id)
            for (const PartLook& was : before.parts)
                if (was.seedVertex == part.seedVertex && near(part.matrix, was.matrix)) part.matrix = was.matrix;
}

/// Keys of what is gone go, and those of a group follow its name.
void carryCurves(const Look& before, Look& look) {
    for (ValueCurve& curve : look.curves)
        if (infoOf(curve.what.value).owner == KeyedValueInfo::Owner::group)
            for (const LightGroup& was : before.groups)
                if (was.name == curve.what.of && !valueOf(look, curve.what, {}))
                    for (const LightGroup& group : look.groups)
                        if (group.members == was.members) {
                            curve.what.of = group.name;
                            break;
                        }
    std::erase_if(look.curves, [&](const ValueCurve& curve) {
        return valueOf(before, curve.what, {}) && !valueOf(look, curve.what, {});
    });
    // An added light that is gone must not be taken for a recovered one.
    std::erase_if(look.curves, [&](const ValueCurve& curve) {
        return infoOf(curve.what.value).ofLight() && named(before.added, curve.what.of) &&
               !named(look.added, curve.what.of);
    });
}

/// How far a value may be off though nobody changed it: a light that is turned or scaled about its place keeps that up
/// to single precision, and angles are taken out of a matrix.
float roundingOf(const Look& look, const KeyedOf& what, float size, const LookPivots& pivots) {
    constexpr float relative = 1e-5f;
    if (what.value == KeyedValue::rotation) return std::max(2e-3f, relative * size);
    if (what.value != KeyedValue::position) return relative * std::max(1e-3f, size);
    const AddedEmitter* added = named(look.added, what.of);
    const auto geometry = added ? infoOf(added->shape).geometry : EmitterShapeInfo::Geometry::emitter;
    if (geometry == EmitterShapeInfo::Geometry::own) return relative * size;
    return relative * (size + glm::length(geometry == EmitterShapeInfo::Geometry::component
                                              ? pivots.vertex(added->seedVertex)
                                              : pivots.emitter(added ? added->source : what.of)));
}

/// What changed of the values that have keys of their own, into those; the look keeps what it had.
void keyValues(const Look& before, Look& look, int frame, const LookPivots& pivots) {
    if (before.curves.empty()) return;
    carryCurves(before, look);
    const std::vector<ValueCurve> curves = look.curves;
    for (const ValueCurve& curve : curves) {
        const auto was = valueOf(before, curve.what, pivots), now = valueOf(look, curve.what, pivots);
        if (!was || !now) continue;
        if (glm::distance(*was, *now) >
            roundingOf(before, curve.what, std::max(glm::length(*was), glm::length(*now)), pivots))
            setValueKey(look, curve.what, frame, pivots);
    }
    for (const ValueCurve& curve : curves)
        if (curve.what.value <= KeyedValue::scale) takeBackMoves(before, look, curve.what.of, pivots);
        else if (const auto was = valueOf(before, curve.what, pivots)) setValue(look, curve.what, *was, pivots);
}

void keyLook(const Look& before, Look& look, int frame) {
    if (look.keys.empty() || look.keys != before.keys || withoutKeys(look) == withoutKeys(before)) return;
    for (LookKey& key : look.keys) {
        carryOver(before, look, key.look);
        carryGroups(before, look, key.look);
    }
    setKey(look, frame);
}

}  // namespace

int keyAt(const Look& look, int frame) {
    for (size_t i = 0; i < look.keys.size(); ++i)
        if (look.keys[i].frame == frame) return int(i);
    return -1;
}

std::vector<int> keyFrames(const Look& look) {
    std::set<int> frames;
    for (const LookKey& key : look.keys) frames.insert(key.frame);
    for (const ValueCurve& curve : look.curves)
        for (const ValueKey& key : curve.keys) frames.insert(key.frame);
    return {frames.begin(), frames.end()};
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

void keyEdit(const Look& before, Look& look, int frame, const LookPivots& pivots) {
    // Keys that came along with a new light are no edit of keys.
    const auto brought = std::stable_partition(look.curves.begin(), look.curves.end(), [&](const ValueCurve& curve) {
        return !infoOf(curve.what.value).ofLight() || named(before.added, curve.what.of) ||
               !named(look.added, curve.what.of);
    });
    const std::vector<ValueCurve> fresh(brought, look.curves.end());
    look.curves.erase(brought, look.curves.end());
    if (look.curves == before.curves && look.keys == before.keys) {
        keyValues(before, look, frame, pivots);
        keyLook(before, look, frame);
    }
    look.curves.insert(look.curves.end(), fresh.begin(), fresh.end());
    applyValueKeys(look, frame, pivots);
}

}  // namespace relamp
