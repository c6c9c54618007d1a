// How an artist's light depends on direction and place, as a value of the look: cone, focus, photometric file, images.
// The names are those of UsdLux's ShapingAPI.
#pragma once
#include <algorithm>
#include <array>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>

namespace relamp {

/// The axis is the light's own -Z. Every part multiplies the radiance; what is not set leaves it alone.
struct LightShaping {
    float coneDegrees = 180;              ///< from the axis to where the light ends; 180: everywhere
    float coneSoftness = 0;               ///< 0 to 1: the fraction of the cone over which it fades
    float focus = 0;                      ///< power of the cosine to the axis; 0: even
    std::filesystem::path iesFile{};      ///< intensity by direction, its largest being 1 (IES LM-63)
    std::filesystem::path goboFile{};     ///< image thrown into the cone, its inscribed circle on the cone's edge
    std::filesystem::path surfaceFile{};  ///< image on a flat light's surface, upright as seen from the front
    /// Degrees that a flat light's barn doors stand open: 90 wide, 0 straight ahead, below it closing over the light.
    /// A door is as long as the light is wide across it. Left and top as the light sees them: -X and +Y.
    float leftDoor = 90, rightDoor = 90, topDoor = 90, bottomDoor = 90;

    bool plain() const { return *this == LightShaping(); }
    bool doors() const { return std::min(std::min(leftDoor, rightDoor), std::min(topDoor, bottomDoor)) < 90; }
    bool operator==(const LightShaping&) const = default;
};

/// A barn door in a look, by its name there.
struct BarnDoor {
    float LightShaping::*degrees;
    const char* key;
    int axis;    ///< across its hinge: 0 is X, 1 is Y
    float side;  ///< of that axis, 1 or -1
};
inline constexpr std::array<BarnDoor, 4> barnDoors{{{&LightShaping::leftDoor, "left_door_degrees", 0, -1},
                                                    {&LightShaping::rightDoor, "right_door_degrees", 0, 1},
                                                    {&LightShaping::topDoor, "top_door_degrees", 1, 1},
                                                    {&LightShaping::bottomDoor, "bottom_door_degrees", 1, -1}}};
inline constexpr float mostShutDoor = -60;  ///< degrees

/// "shaping" of docs/interface.md 3; `where` names it in errors. Relative file names are taken from `folder`. Throws
/// Error naming the field.
LightShaping shapingFromJson(const nlohmann::json& object, const std::string& where,
                             const std::filesystem::path& folder);
/// Only what differs from a light without shaping.
nlohmann::json shapingToJson(const LightShaping& shaping);

/// Between keys: numbers blend, files are those of `a`.
LightShaping blendShapings(const LightShaping& a, const LightShaping& b, float t);

}  // namespace relamp
