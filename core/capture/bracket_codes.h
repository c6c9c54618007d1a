// What the response curve and the merging of a bracket share: tables over the 256 codes, and the order of exposures.
// Not a door.
#pragma once
#include <algorithm>
#include <array>
#include <vector>

#include "image/image.h"

namespace relamp {

constexpr int bracketCodes = 256;
/// Codes outside are clipped, or nearly: encoders ring, and noise is cut off.
constexpr double lowestCode = 3, highestCode = 250;
constexpr double lowestNoise = 0.29;  ///< of rounding to whole codes

using CodeTable = std::array<double, bracketCodes>;

inline double atCode(const CodeTable& table, double code) {
    const double z = std::clamp(code, 0.0, 255.0);
    const int i = std::min(int(z), bracketCodes - 2);
    const double f = z - i;
    return table[size_t(i)] * (1 - f) + table[size_t(i) + 1] * f;
}

/// Slope of ln exposure by code, over a few codes because the table is a fit.
inline double slopeAt(const CodeTable& table, double code) {
    const double low = std::clamp(code - 1.5, 0.0, 252.0), high = low + 3;
    return std::max((atCode(table, high) - atCode(table, low)) / 3, 1e-5);
}

/// The exposure most pixels of which are neither bright nor dark; the first of `order` among equals.
size_t bestExposed(const std::vector<CodeImage>& images, const std::vector<size_t>& order);

/// Places of the exposures, from the shortest to the longest.
std::vector<size_t> fromShortest(const std::vector<double>& exposures);

}  // namespace relamp
