// Measured reflectance: MERL's .binary files [Matusik03]. They are read where the user has them; nothing of them is
// part of relamp.
#pragma once
#include <array>
#include <filesystem>
#include <vector>

#include "base/math.h"

namespace relamp {

/// An isotropic BRDF on the half-vector grid of [Rusinkiewicz98]: 90 angles of the half vector, dense near the normal,
/// 90 of the difference vector, 180 of its azimuth over half a turn (the other half is the same by reciprocity).
struct MeasuredBrdf {
    static constexpr int halfSteps = 90, differenceSteps = 90, azimuthSteps = 180;
    std::string name;  ///< file name without its ending
    /// Per steradian, without the cosine, azimuth fastest, then difference, then half angle; negative in all channels
    /// where the direction lies below the horizon and nothing was measured.
    std::vector<Rgb> cells;
    size_t missing = 0;  ///< cells without a measurement

    /// Interpolated between the eight cells around; those without a measurement are left out. 0 below the horizon, and
    /// where none of the eight was measured. Local frame, +Z is the normal. Reciprocal up to rounding.
    Rgb evaluate(const Vec3& towardLight, const Vec3& towardEye) const;
    static size_t index(int half, int difference, int azimuth) {
        return (size_t(half) * differenceSteps + size_t(difference)) * azimuthSteps + size_t(azimuth);
    }
};

/// Reads a .binary file: three counts (90, 90, 180), then red, green and blue as doubles, scaled by 1, 1.15 and 1.66
/// over 1500. Throws Error naming the file and the field: other counts, another size, a value that is no number,
/// nothing measured.
MeasuredBrdf readMerl(const std::filesystem::path& file);

/// Half and difference angles of a pair of directions, radians: theta_h in [0, pi/2], theta_d in [0, pi/2], phi_d in
/// [0, pi).
struct HalfAngles {
    double half = 0, difference = 0, azimuth = 0;
};
HalfAngles halfAngles(const Vec3& towardLight, const Vec3& towardEye);

/// A cell of the grid and its fraction in an interpolated value.
struct MerlCorner {
    size_t cell = 0;
    double weight = 0;
};
/// The eight cells around a pair of directions; the weights add up to 1.
std::array<MerlCorner, 8> merlCorners(const Vec3& towardLight, const Vec3& towardEye);

}  // namespace relamp
