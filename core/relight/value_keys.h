// Keys of single values of a look: a light's exposure, its position, how far the environment is turned. Between two
// keys of a value it goes from one to the other, whatever the rest of the look does.
#pragma once
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/math.h"

namespace relamp {

struct Look;
struct LookPivots;

/// How a key goes over into the next one.
enum class KeyEase { linear, smooth, hold };
/// In files.
inline constexpr const char* keyEaseNames[] = {"linear", "smooth", "hold"};
/// The fraction of the way from one value to the next that is done after the fraction t of the time; 0 and 1 stay.
float eased(KeyEase ease, float t);

enum class KeyedValue {
    position,
    rotation,
    scale,
    powerScale,
    radiance,
    enabled,
    shadows,
    size,
    coneDegrees,
    coneSoftness,
    focus,
    leftDoor,
    rightDoor,
    topDoor,
    bottomDoor,
    groupPower,
    groupEnabled,
    yaw,
    exposure,
    tint,
    neutral
};

struct KeyedValueInfo {
    KeyedValue value;
    const char* name;   ///< in the edits document (docs/interface.md 3)
    const char* label;  ///< in the window
    /// Whose value it is: a light's of any kind, a recovered one's, an added one's, one's with a shape of its own,
    /// one's that can be shaped, a group's, or the whole look's.
    enum class Owner { light, recovered, added, own, shaped, group, look } owner;
    int components = 1;
    /// How it goes from key to key: evenly; in even steps of stops, or evenly from or to 0; at once.
    enum class Kind { number, light, flag } kind = Kind::number;
    float least = 0, most = 0;
    bool ofLight() const { return owner < Owner::group; }
};

/// In the order of KeyedValue.
std::span<const KeyedValueInfo> keyedValues();
const KeyedValueInfo& infoOf(KeyedValue value);

/// One value of one thing.
struct KeyedOf {
    KeyedValue value = KeyedValue::yaw;
    std::string of{};  ///< id of a light or name of a group; empty for values of the whole look
    bool operator==(const KeyedOf&) const = default;
};

struct ValueKey {
    int frame = 1;
    Vec3 value{0};  ///< as many components as the value has, the rest 0; of a flag 0 or 1
    KeyEase ease = KeyEase::linear;
    bool operator==(const ValueKey&) const = default;
};

/// The keys of one value: at least one, by frame, none twice.
struct ValueCurve {
    KeyedOf what;
    std::vector<ValueKey> keys;
    bool operator==(const ValueCurve&) const = default;
};

/// Before the first key its value, after the last one that one's. Cost: of order of the number of keys.
Vec3 valueAt(const ValueCurve& curve, int frame);

/// The value as a look has it, in the form of its keys; nothing where the look has no such thing. Position, metres: of
/// a light with a shape of its own in the world, of others from where it was captured. Rotation: degrees about x, then
/// y, then z (placement.h).
std::optional<Vec3> valueOf(const Look& look, const KeyedOf& what, const LookPivots& pivots);
/// Gives the look that value; what is attached to a light moves along. Nothing happens where there is no such thing.
void setValue(Look& look, const KeyedOf& what, const Vec3& value, const LookPivots& pivots);

/// Gives the look the values that its keys of values have at a frame.
void applyValueKeys(Look& look, int frame, const LookPivots& pivots);

/// `value_keys` of an edits document; `look` has the rest of it, with its keys. Throws Error naming the field.
/// `origin`: as for lookFromJson.
std::vector<ValueCurve> valueKeysFromJson(const nlohmann::json& document, const Look& look, const DVec3& origin);
nlohmann::json valueKeysToJson(const Look& look, const DVec3& origin);
/// `frame` and `ease` of a key; `where` names it in errors.
int keyFrameFromJson(const nlohmann::json& key, const std::string& where);
KeyEase keyEaseFromJson(const nlohmann::json& key, const std::string& where);

}  // namespace relamp
