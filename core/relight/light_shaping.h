// How an artist's light depends on direction and place, as a value of the look: cone, focus, photometric file, images.
// The names are those of UsdLux's ShapingAPI.
#pragma once
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

    bool plain() const { return *this == LightShaping(); }
    bool operator==(const LightShaping&) const = default;
};

/// "shaping" of docs/interface.md 3; `where` names it in errors. Relative file names are taken from `folder`. Throws
/// Error naming the field.
LightShaping shapingFromJson(const nlohmann::json& object, const std::string& where,
                             const std::filesystem::path& folder);
/// Only what differs from a light without shaping.
nlohmann::json shapingToJson(const LightShaping& shaping);

/// Between keys: numbers blend, files are those of `a`.
LightShaping blendShapings(const LightShaping& a, const LightShaping& b, float t);

}  // namespace relamp
