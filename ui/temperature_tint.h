// The colour of a light as two numbers that photographers use: temperature, from warm to cool, and tint, from magenta
// to green. The one does not move the other.
#pragma once
#include "base/math.h"

namespace relamp::ui {

struct TemperatureTint {
    float kelvin = 6504;
    float tint = 0;  ///< stops of green against red and blue; negative is magenta
};

/// The temperature is the one whose white has the same ratio of red to blue. Black counts as white. Cost: some 40
/// evaluations of kelvinTint.
TemperatureTint splitColour(const Rgb& colour);
/// Linear Rec.709 of luminance 1; splitColour gives both numbers back where red and blue are not 0.
Rgb joinColour(const TemperatureTint& parts);

}  // namespace relamp::ui
