#include "relight/value_keys.h"

#include <algorithm>
#include <cmath>

#include "relight/look_track.h"
#include "relight/placement.h"

namespace relamp {
namespace {

using Owner = KeyedValueInfo::Owner;
using Kind = KeyedValueInfo::Kind;

constexpr KeyedValueInfo valueTable[] = {
    {KeyedValue::position, "position", "Position", Owner::light, 3, Kind::number, -1e9f, 1e9f},
    {KeyedValue::rotation, "rotation", "Rotation", Owner::light, 3, Kind::number, -1e6f, 1e6f},
    {KeyedValue::scale, "scale", "Scale", Owner::light, 3, Kind::number, -1e6f, 1e6f},
    {KeyedValue::powerScale, "power_scale", "Exposure and colour", Owner::recovered, 3, Kind::light, 0, 1e30f},
    {KeyedValue::radiance, "radiance", "Exposure and colour", Owner::added, 3, Kind::light, 0, 1e30f},
    {KeyedValue::enabled, "enabled", "Shines", Owner::light, 1, Kind::flag, 0, 1},
    {KeyedValue::shadows, "shadows", "Casts shadows", Owner::light, 1, Kind::flag, 0, 1},
    {KeyedValue::size, "size", "Size", Owner::own, 2, Kind::number, 1e-6f, 1e9f},
    {KeyedValue::coneDegrees, "shaping.cone_degrees", "Cone", Owner::shaped, 1, Kind::number, 0.1f, 180},
    {KeyedValue::coneSoftness, "shaping.cone_softness", "Softness", Owner::shaped, 1, Kind::number, 0, 1},
    {KeyedValue::focus, "shaping.focus", "Focus", Owner::shaped, 1, Kind::number, 0, 1000},
    {KeyedValue::leftDoor, "shaping.left_door_degrees", "Left door", Owner::shaped, 1, Kind::number, mostShutDoor, 90},
    {KeyedValue::rightDoor, "shaping.right_door_degrees", "Right door", Owner::shaped, 1, Kind::number, mostShutDoor,
     90},
    {KeyedValue::topDoor, "shaping.top_door_degrees", "Top door", Owner::shaped, 1, Kind::number, mostShutDoor, 90},
    {KeyedValue::bottomDoor, "shaping.bottom_door_degrees", "Bottom door", Owner::shaped, 1, Kind::number, mostShutDoor,
     90},
    {KeyedValue::groupPower, "power_scale", "Exposure and colour", Owner::group, 3, Kind::light, 0, 1e30f},
    {KeyedValue::groupEnabled, "enabled", "Shines", Owner::group, 1, Kind::flag, 0, 1},
    {KeyedValue::yaw, "environment.yaw_degrees", "Rotation", Owner::look, 1, Kind::number, -1e6f, 1e6f},
    {KeyedValue::exposure, "environment.exposure_stops", "Exposure", Owner::look, 1, Kind::number, -64, 64},
    {KeyedValue::tint, "environment.tint", "Tint", Owner::look, 3, Kind::light, 0, 1e30f},
    {KeyedValue::neutral, "materials.neutral", "Neutral surfaces", Owner::look, 1, Kind::flag, 0, 1}};

template <class List, class Same>
auto* find(List& list, Same&& same) {
    const auto at = std::find_if(list.begin(), list.end(), same);
    return at == list.end() ? nullptr : &*at;
}

template <class AnyLook>
auto* addedIn(AnyLook& look, const std::string& id) {
    return find(look.added, [&](const AddedEmitter& e) { return e.id == id; });
}

template <class AnyLook>
auto* groupIn(AnyLook& look, const std::string& name) {
    return find(look.groups, [&](const LightGroup& g) { return g.name == name; });
}

/// Where the matrix of a light has been taken apart about: what its position is the place of.
Vec3 pivotOf(const AddedEmitter* added, const std::string& id, const LookPivots& pivots) {
    if (!added) return pivots.emitter(id);
    switch (infoOf(added->shape).geometry) {
        case EmitterShapeInfo::Geometry::component: return pivots.vertex(added->seedVertex);
        case EmitterShapeInfo::Geometry::emitter: return pivots.emitter(added->source);
        case EmitterShapeInfo::Geometry::own: break;
    }
    return Vec3(0);
}

/// Keyed values have the order of barnDoors.
float LightShaping::*doorOf(KeyedValue value) {
    return barnDoors[size_t(value) - size_t(KeyedValue::leftDoor)].degrees;
}

bool applies(Owner owner, const AddedEmitter* added) {
    switch (owner) {
        case Owner::recovered: return !added;
        case Owner::added: return added;
        case Owner::own: return added && infoOf(added->shape).own();
        case Owner::shaped: return added && infoOf(added->shape).shapeable();
        default: return true;
    }
}

Vec3 moved(const Mat4& matrix, const Vec3& pivot) {
    return Vec3(DMat4(matrix) * glm::dvec4(DVec3(pivot), 1) - glm::dvec4(DVec3(pivot), 1));
}

/// World to world: from a light with this matrix to one with the value.
DMat4 moveTo(const Mat4& matrix, KeyedValue value, const Vec3& wanted, const Vec3& pivot) {
    DMat4 change(1);
    if (value == KeyedValue::position) {
        change[3] = glm::dvec4(DVec3(wanted) - DVec3(moved(matrix, pivot)), 1);
        return change;
    }
    const Placement now = placementOf(matrix);
    const glm::dmat3 turn(rotationOf(now.degrees));
    glm::dmat3 linear(1);
    if (value == KeyedValue::rotation) {
        linear = glm::dmat3(rotationOf(wanted)) * glm::transpose(turn);
    } else {
        for (int k = 0; k < 3; ++k) {
            // Through 0 a light would lose its inside.
            const float size = std::abs(wanted[k]) < 1e-6f ? std::copysign(1e-6f, wanted[k]) : wanted[k];
            linear[k][k] = double(size) / double(now.scale[k]);
        }
        linear = turn * linear * glm::transpose(turn);
    }
    const DVec3 about(DMat4(matrix) * glm::dvec4(DVec3(pivot), 1));
    change = DMat4(linear);
    change[3] = glm::dvec4(about - linear * about, 1);
    return change;
}

std::optional<Vec3> valueOfLight(const Look& look, const KeyedOf& what, const LookPivots& pivots) {
    const AddedEmitter* added = addedIn(look, what.of);
    if (!applies(infoOf(what.value).owner, added)) return {};
    EmitterLook recovered;
    if (!added)
        if (const EmitterLook* e = find(look.emitters, [&](const EmitterLook& x) { return x.id == what.of; }))
            recovered = *e;
    const Mat4& matrix = added ? added->matrix : recovered.matrix;
    switch (what.value) {
        case KeyedValue::position: return moved(matrix, pivotOf(added, what.of, pivots));
        case KeyedValue::rotation: return placementOf(matrix).degrees;
        case KeyedValue::scale: return placementOf(matrix).scale;
        case KeyedValue::powerScale: return recovered.powerScale;
        case KeyedValue::radiance: return added->radiance;
        case KeyedValue::enabled: return Vec3(added ? added->enabled : recovered.enabled, 0, 0);
        case KeyedValue::shadows: return Vec3(added ? added->shadows : recovered.shadows, 0, 0);
        case KeyedValue::size: return Vec3(added->size, 0);
        case KeyedValue::coneDegrees: return Vec3(added->shaping.coneDegrees, 0, 0);
        case KeyedValue::coneSoftness: return Vec3(added->shaping.coneSoftness, 0, 0);
        case KeyedValue::focus: return Vec3(added->shaping.focus, 0, 0);
        case KeyedValue::leftDoor:
        case KeyedValue::rightDoor:
        case KeyedValue::topDoor:
        case KeyedValue::bottomDoor: return Vec3(added->shaping.*doorOf(what.value), 0, 0);
        default: return {};
    }
}

void setValueOfLight(Look& look, const KeyedOf& what, const Vec3& value, const LookPivots& pivots) {
    AddedEmitter* added = addedIn(look, what.of);
    if (!applies(infoOf(what.value).owner, added)) return;
    EmitterLook* recovered = nullptr;
    if (!added) {
        recovered = find(look.emitters, [&](const EmitterLook& x) { return x.id == what.of; });
        if (!recovered) {
            look.emitters.push_back({});
            recovered = &look.emitters.back();
            recovered->id = what.of;
        }
    }
    switch (what.value) {
        case KeyedValue::position:
        case KeyedValue::rotation:
        case KeyedValue::scale: {
            Mat4& matrix = added ? added->matrix : recovered->matrix;
            const DMat4 change = moveTo(matrix, what.value, value, pivotOf(added, what.of, pivots));
            if (change == DMat4(1)) return;
            matrix = Mat4(change * DMat4(matrix));
            for (PartLook& part : look.parts)
                if (part.attachedTo == what.of) part.matrix = Mat4(change * DMat4(part.matrix));
            return;
        }
        case KeyedValue::powerScale: recovered->powerScale = value; return;
        case KeyedValue::radiance: added->radiance = value; return;
        case KeyedValue::enabled: (added ? added->enabled : recovered->enabled) = value.x > 0.5f; return;
        case KeyedValue::shadows: (added ? added->shadows : recovered->shadows) = value.x > 0.5f; return;
        case KeyedValue::size: added->size = Vec2(value); return;
        case KeyedValue::coneDegrees: added->shaping.coneDegrees = value.x; return;
        case KeyedValue::coneSoftness: added->shaping.coneSoftness = value.x; return;
        case KeyedValue::focus: added->shaping.focus = value.x; return;
        case KeyedValue::leftDoor:
        case KeyedValue::rightDoor:
        case KeyedValue::topDoor:
        case KeyedValue::bottomDoor: added->shaping.*doorOf(what.value) = value.x; return;
        default: return;
    }
}

}  // namespace

float eased(KeyEase ease, float t) {
    return ease == KeyEase::hold ? 0.0f : ease == KeyEase::smooth ? t * t * (3 - 2 * t) : t;
}

std::span<const KeyedValueInfo> keyedValues() { return valueTable; }
const KeyedValueInfo& infoOf(KeyedValue value) { return valueTable[size_t(value)]; }

Vec3 valueAt(const ValueCurve& curve, int frame) {
    const auto after =
        std::find_if(curve.keys.begin(), curve.keys.end(), [&](const ValueKey& key) { return key.frame > frame; });
    if (after == curve.keys.begin()) return after == curve.keys.end() ? Vec3(0) : after->value;
    const ValueKey& from = *std::prev(after);
    if (after == curve.keys.end() || from.frame == frame) return from.value;
    const Kind kind = infoOf(curve.what.value).kind;
    const float t = kind == Kind::flag
                        ? 0
                        : eased(from.ease, float(frame - from.frame) / float(int64_t(after->frame) - from.frame));
    return kind == Kind::light ? blendLight(from.value, after->value, t) : (1 - t) * from.value + t * after->value;
}

std::optional<Vec3> valueOf(const Look& look, const KeyedOf& what, const LookPivots& pivots) {
    const LightGroup* group = infoOf(what.value).owner == Owner::group ? groupIn(look, what.of) : nullptr;
    switch (what.value) {
        case KeyedValue::groupPower: return group ? std::optional(Vec3(group->powerScale)) : std::nullopt;
        case KeyedValue::groupEnabled: return group ? std::optional(Vec3(group->enabled, 0, 0)) : std::nullopt;
        case KeyedValue::yaw: return Vec3(look.environment.yawDegrees, 0, 0);
        case KeyedValue::exposure: return Vec3(look.environment.exposureStops, 0, 0);
        case KeyedValue::tint: return look.environment.tint;
        case KeyedValue::neutral: return Vec3(look.neutralMaterials, 0, 0);
        default: return valueOfLight(look, what, pivots);
    }
}

void setValue(Look& look, const KeyedOf& what, const Vec3& value, const LookPivots& pivots) {
    LightGroup* group = infoOf(what.value).owner == Owner::group ? groupIn(look, what.of) : nullptr;
    switch (what.value) {
        case KeyedValue::groupPower:
            if (group) group->powerScale = value;
            return;
        case KeyedValue::groupEnabled:
            if (group) group->enabled = value.x > 0.5f;
            return;
        case KeyedValue::yaw: look.environment.yawDegrees = value.x; return;
        case KeyedValue::exposure: look.environment.exposureStops = value.x; return;
        case KeyedValue::tint: look.environment.tint = value; return;
        case KeyedValue::neutral: look.neutralMaterials = value.x > 0.5f; return;
        default: setValueOfLight(look, what, value, pivots);
    }
}

void applyValueKeys(Look& look, int frame, const LookPivots& pivots) {
    for (const ValueCurve& curve : look.curves) setValue(look, curve.what, valueAt(curve, frame), pivots);
}

}  // namespace relamp
