// Colour temperature: what an artist says of a light ("2700 K is a warm bulb") as linear Rec.709, and back.
#pragma once
#include "base/math.h"

namespace relamp {

inline constexpr float lowestKelvin = 1000, highestKelvin = 25000;
/// Daylight that Rec.709 calls white (D65).
inline constexpr float whiteKelvin = 6504;

/// CIE 1931 xy of a light of this temperature, clamped to the range above. Up to 4000 K a glowing part, [Krystek85]
/// equations 3 and 4 (off by at most 9e-5 in CIE 1960 uv); from 5000 K daylight, [CIE15] section 3; between them a
/// straight blend in uv, as [TM30] blends its reference lights. So 2856 K is CIE illuminant A and 6504 K is D65.
Vec2 kelvinChromaticity(float kelvin);

/// Linear Rec.709 of luminance 1 with that chromaticity: (1, 1, 1) to 1e-3 at whiteKelvin. Below about 1900 K the
/// colour lies outside Rec.709; blue is then 0 and the luminance still 1.
Rgb kelvinTint(float kelvin);

struct NearestKelvin {
    float kelvin = whiteKelvin;
    float distance =
        0;  ///< CIE 1960 uv; above 0.02 the colour is greenish or pinkish, and a temperature does not describe it
};
/// Temperature whose chromaticity is nearest. Black counts as white. Cost: some 60 evaluations.
NearestKelvin nearestKelvin(const Rgb& colour);

}  // namespace relamp
