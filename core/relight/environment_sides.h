// The environment brighter or darker from six sides: the part of low frequency that an artist changes.
#pragma once
#include <array>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "relight/distant_light.h"

namespace relamp {

/// Factors on light from +X, -X, +Y, -Y, +Z and -Z of the world. In between they go over into each other with the
/// squares of the direction's coordinates, whose sum is 1: the ambient cube [McTaggart04].
using EnvironmentSides = std::array<Rgb, 6>;
inline constexpr EnvironmentSides evenSides{Rgb(1), Rgb(1), Rgb(1), Rgb(1), Rgb(1), Rgb(1)};
inline constexpr std::array<const char*, 6> sideNames{"+X", "-X", "+Y", "-Y", "+Z", "-Z"};

/// Part of a side in light from the unit direction, 0 to 1.
inline float sidePart(size_t side, const Vec3& direction) {
    const float along = direction[int(side / 2)] * (side % 2 ? -1.0f : 1.0f);
    return along > 0 ? along * along : 0.0f;
}
Rgb sideFactor(const EnvironmentSides& sides, const Vec3& direction);

/// The light with the factors, at the centre of each cell; the same object where all are 1.
std::shared_ptr<const DistantLight> sided(std::shared_ptr<const DistantLight> light, const EnvironmentSides& sides);

/// "environment.sides" of docs/interface.md 3: six lists of three factors, 0 or more. Throws Error naming the field.
EnvironmentSides sidesFromJson(const nlohmann::json& value, const std::string& where);
nlohmann::json sidesToJson(const EnvironmentSides& sides);

}  // namespace relamp
