#include "edit/value_key_edits.h"

#include <algorithm>
#include <cmath>

#include "relight/placement.h"

namespace relamp {
namespace {

template <class AnyLook>
auto* curveIn(AnyLook& look, const KeyedOf& what) {
    const auto at = std::find_if(look.curves.begin(), look.curves.end(),
                                 [&](const ValueCurve& curve) { return curve.what == what; });
    return at == look.curves.end() ? nullptr : &*at;
}

/// A key between two goes on as the one before it.
KeyEase easeAt(const ValueCurve& curve, int frame) {
    KeyEase ease = KeyEase::linear;
    for (const ValueKey& key : curve.keys)
        if (key.frame <= frame) ease = key.ease;
    return ease;
}

/// Puts the key in; one that is at its frame already gives way.
void putKey(ValueCurve& curve, const ValueKey& key) {
    std::erase_if(curve.keys, [&](const ValueKey& k) { return k.frame == key.frame; });
    const auto after =
        std::find_if(curve.keys.begin(), curve.keys.end(), [&](const ValueKey& k) { return k.frame > key.frame; });
    curve.keys.insert(after, key);
}

Vec3 draggedValue(const KeyedOf& what, Vec3 value, const KeyDrag& drag) {
    const KeyedValueInfo& info = infoOf(what.value);
    if (info.kind == KeyedValueInfo::Kind::light) return glm::min(value * std::exp2(drag.amount), Vec3(info.most));
    float& number = value[std::clamp(drag.component, 0, info.components - 1)];
    number = std::clamp(number + drag.amount, info.least, info.most);
    if (info.kind == KeyedValueInfo::Kind::flag) number = number > 0.5f;
    return value;
}

}  // namespace

const ValueCurve* curveOf(const Look& look, const KeyedOf& what) { return curveIn(look, what); }

const ValueKey* valueKeyAt(const ValueCurve& curve, int frame) {
    for (const ValueKey& key : curve.keys)
        if (key.frame == frame) return &key;
    return nullptr;
}

void setValueKey(Look& look, const KeyedOf& what, int frame, const LookPivots& pivots) {
    const std::optional<Vec3> value = valueOf(look, what, pivots);
    if (!value) return;
    ValueCurve* curve = curveIn(look, what);
    if (!curve) {
        look.curves.push_back({what, {{frame, *value, KeyEase::linear}}});
        return;
    }
    ValueKey key{frame, *value, easeAt(*curve, frame)};
    if (what.value == KeyedValue::rotation) key.value = anglesNear(*value, valueAt(*curve, frame));
    if (what.value == KeyedValue::yaw) key.value.x += 360 * std::round((valueAt(*curve, frame).x - key.value.x) / 360);
    putKey(*curve, key);
}

void putOnCurve(Look& look, const KeyedOf& what, int frame) {
    ValueCurve* curve = curveIn(look, what);
    if (!curve || valueKeyAt(*curve, frame)) return;
    putKey(*curve, {frame, valueAt(*curve, frame), easeAt(*curve, frame)});
}

void deleteValueKey(Look& look, const KeyedOf& what, int frame) { deleteValueKeys(look, {{what, frame}}); }

std::vector<KeyPick> dragValueKeys(Look& look, const std::vector<KeyPick>& picks, const KeyDrag& drag) {
    std::vector<KeyPick> moved;
    std::vector<ValueKey> keys;
    for (const KeyPick& pick : picks) {
        ValueCurve* curve = curveIn(look, pick.what);
        const ValueKey* key = curve ? valueKeyAt(*curve, pick.frame) : nullptr;
        if (!key) continue;
        ValueKey to = *key;
        to.frame = int(std::clamp<int64_t>(int64_t(pick.frame) + drag.frames, 0, 100'000'000));
        to.value = draggedValue(pick.what, to.value, drag);
        moved.push_back({pick.what, to.frame});
        keys.push_back(to);
        std::erase_if(curve->keys, [&](const ValueKey& k) { return k.frame == pick.frame; });
    }
    for (size_t i = 0; i < moved.size(); ++i) putKey(*curveIn(look, moved[i].what), keys[i]);
    return moved;
}

void easeValueKeys(Look& look, const std::vector<KeyPick>& picks, KeyEase ease) {
    for (const KeyPick& pick : picks)
        if (ValueCurve* curve = curveIn(look, pick.what))
            for (ValueKey& key : curve->keys)
                if (key.frame == pick.frame) key.ease = ease;
}

void deleteValueKeys(Look& look, const std::vector<KeyPick>& picks) {
    for (const KeyPick& pick : picks)
        if (ValueCurve* curve = curveIn(look, pick.what))
            std::erase_if(curve->keys, [&](const ValueKey& key) { return key.frame == pick.frame; });
    std::erase_if(look.curves, [](const ValueCurve& curve) { return curve.keys.empty(); });
}

void copyValueKeys(Look& look, const std::string& from, const std::string& to, const Vec3& offset,
                   const std::optional<Rgb>& recoveredRadiance) {
    std::vector<ValueCurve> copies;
    for (const ValueCurve& curve : look.curves) {
        if (!infoOf(curve.what.value).ofLight() || curve.what.of != from) continue;
        ValueCurve copy = curve;
        copy.what.of = to;
        if (copy.what.value == KeyedValue::powerScale) copy.what.value = KeyedValue::radiance;
        for (ValueKey& key : copy.keys) {
            if (curve.what.value == KeyedValue::position) key.value += offset;
            if (curve.what.value == KeyedValue::powerScale) key.value *= recoveredRadiance.value_or(Rgb(1));
        }
        copies.push_back(std::move(copy));
    }
    look.curves.insert(look.curves.end(), copies.begin(), copies.end());
}

}  // namespace relamp
