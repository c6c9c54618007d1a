// Keys of single values: set, taken away, dragged in time and value, eased, as an artist does in a view of curves.
#pragma once
#include "relight/look_track.h"

namespace relamp {

/// Null: the value has no keys.
const ValueCurve* curveOf(const Look& look, const KeyedOf& what);
/// Null: none at that frame.
const ValueKey* valueKeyAt(const ValueCurve& curve, int frame);

/// The value as the look has it becomes its key at `frame`; the first one makes the value keyed. A new one between two
/// goes on as the one before it. Angles take the turn nearest to that of the curve there. Nothing happens where
/// the look has no such thing.
void setValueKey(Look& look, const KeyedOf& what, int frame, const LookPivots& pivots);
/// A key with the value that the curve has at `frame` already.
void putOnCurve(Look& look, const KeyedOf& what, int frame);
/// Nothing happens where there is none. The last key leaves the look's own value behind.
void deleteValueKey(Look& look, const KeyedOf& what, int frame);

/// One key of one value.
struct KeyPick {
    KeyedOf what;
    int frame = 1;
    bool operator==(const KeyPick&) const = default;
};
/// What a drag in a view of curves does to keys: of a light (KeyedValueInfo::Kind) `amount` is in stops and goes to all
/// components, of other values in their own unit and to `component` alone.
struct KeyDrag {
    int frames = 0;
    float amount = 0;
    int component = 0;
};
/// Keys that the moved ones land on give way. Frames stay 0 or more, values in their range. Returns the keys where they
/// are then; those that do not exist are left out.
std::vector<KeyPick> dragValueKeys(Look& look, const std::vector<KeyPick>& picks, const KeyDrag& drag);
void easeValueKeys(Look& look, const std::vector<KeyPick>& picks, KeyEase ease);
void deleteValueKeys(Look& look, const std::vector<KeyPick>& picks);

/// The copy of a light goes through what the light goes through: it gets keys of its own for each value that has keys,
/// with places `offset` metres away. `recoveredRadiance`: what a recovered light sends by itself, which its copy has as
/// its own; nothing where the light was added.
void copyValueKeys(Look& look, const std::string& from, const std::string& to, const Vec3& offset,
                   const std::optional<Rgb>& recoveredRadiance);

}  // namespace relamp
