// Photometric files of luminaires: candela by direction (ANSI/IES LM-63-1986 to 2002, type C).
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "base/math.h"

namespace relamp {

/// Luminous intensity by direction, interpolated linearly in both angles.
struct IesProfile {
    std::vector<float> vertical;    ///< degrees from straight down, ascending, 0 to 180
    std::vector<float> horizontal;  ///< degrees about the axis, ascending from 0; one, or up to 90, 180 or 360
    std::vector<float> candela;     ///< horizontal.size() x vertical.size()
    float most = 0;                 ///< largest candela, above 0

    /// Fraction of the largest intensity, 0 to 1, in the unit direction `d` of the luminaire's own axes: -Z is straight
    /// down (vertical angle 0), +X is the half plane of horizontal angle 0. 0 beyond the angles measured.
    float at(const Vec3& d) const;
};

/// Throws Error naming the line's meaning: no photometric data, counts that the text does not hold, angles that do not
/// ascend, types A and B, negative or no light. `text` of a file of at most 8 MiB.
IesProfile iesFromText(const std::string& text);
/// Throws Error naming the file.
IesProfile readIes(const std::filesystem::path& file);

}  // namespace relamp
