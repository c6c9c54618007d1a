// Colour primaries of a file header, turned into a matrix to linear Rec.709.
#pragma once
#include <array>
#include <optional>

#include "base/math.h"

namespace relamp {

/// CIE 1931 xy of red, green, blue and white, as in the OpenEXR `chromaticities` attribute.
using Chromaticities = std::array<float, 8>;

inline constexpr Chromaticities rec709Chromaticities{0.64f, 0.33f, 0.30f, 0.60f, 0.15f, 0.06f, 0.3127f, 0.3290f};

/// Whether the primaries are Rec.709's to 1e-3.
bool isRec709(const Chromaticities& c);

/// rec709FromFile: multiplies a linear colour with the given primaries. The white point is adapted (Bradford), so that
/// the file's white stays (1, 1, 1). None when the primaries are no numbers or span no area.
std::optional<Mat3> rec709From(const Chromaticities& c);

}  // namespace relamp
