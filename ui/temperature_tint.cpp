#include "temperature_tint.h"

#include <algorithm>
#include <cmath>

#include "image/colour_temperature.h"

namespace relamp::ui {
namespace {

constexpr float leastChannel = 1e-4f;
constexpr float mostTint = 4;

float redOverBlue(const Rgb& c) { return std::log2(std::max(c.x, leastChannel) / std::max(c.z, leastChannel)); }

}  // namespace

TemperatureTint splitColour(const Rgb& colour) {
    const float most = maxChannel(colour);
    if (!(most > 0) || !std::isfinite(most)) return {};
    const Rgb c = glm::max(colour / most, Rgb(leastChannel));
    // Red over blue falls as the temperature rises.
    float low = lowestKelvin, high = highestKelvin;
    const float wanted = redOverBlue(c);
    for (int i = 0; i < 40; ++i) {
        const float middle = 0.5f * (low + high);
        (redOverBlue(kelvinTint(middle)) > wanted ? low : high) = middle;
    }
    TemperatureTint parts;
    parts.kelvin = 0.5f * (low + high);
    if (std::abs(parts.kelvin - whiteKelvin) < 3) parts.kelvin = whiteKelvin;
    const Rgb ratio = c / glm::max(kelvinTint(parts.kelvin), Rgb(leastChannel));
    parts.tint = std::clamp(std::log2(ratio.y / std::sqrt(ratio.x * ratio.z)), -mostTint, mostTint);
    if (std::abs(parts.tint) < 5e-4f) parts.tint = 0;
    return parts;
}

Rgb joinColour(const TemperatureTint& parts) {
    Rgb c = kelvinTint(parts.kelvin);
    c.y *= std::exp2(parts.tint);
    return c / std::max(luminance(c), 1e-12f);
}

}  // namespace relamp::ui
