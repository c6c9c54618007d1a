#include "image/colour_temperature.h"

namespace relamp {
namespace {
using DVec2 = glm::dvec2;

DVec2 uvOf(const DVec2& xy) { return DVec2(4 * xy.x, 6 * xy.y) / (-2 * xy.x + 12 * xy.y + 3); }
DVec2 xyOf(const DVec2& uv) { return DVec2(3 * uv.x, 2 * uv.y) / (2 * uv.x - 8 * uv.y + 4); }

/// [Krystek85], 1000 to 15000 K, CIE 1960 uv.
DVec2 radiator(double t) {
    return {
        (0.860117757 + 1.54118254e-4 * t + 1.28641212e-7 * t * t) / (1 + 8.42420235e-4 * t + 7.08145163e-7 * t * t),
        (0.317398726 + 4.22806245e-5 * t + 4.20481691e-8 * t * t) / (1 - 2.89741816e-5 * t + 1.61456053e-7 * t * t)};
}

/// [CIE15], 4000 to 25000 K, CIE 1960 uv.
DVec2 daylight(double t) {
    const double i = 1e3 / t;
    const double x = t <= 7000 ? ((-4.6070 * i + 2.9678) * i + 0.09911) * i + 0.244063
                               : ((-2.0064 * i + 1.9018) * i + 0.24748) * i + 0.237040;
    return uvOf({x, (-3 * x + 2.870) * x - 0.275});
}

DVec2 uvOfKelvin(double kelvin) {
    const double t = std::clamp(kelvin, double(lowestKelvin), double(highestKelvin));
    if (t <= 4000) return radiator(t);
    if (t >= 5000) return daylight(t);
    return glm::mix(radiator(t), daylight(t), (t - 4000) / 1000);
}

/// IEC 61966-2-1 primaries, white D65 = (0.3127, 0.3290).
DVec3 xyzFromRec709(const DVec3& c) {
    return {0.4123907993 * c.x + 0.3575843394 * c.y + 0.1804807884 * c.z,
            0.2126390059 * c.x + 0.7151686788 * c.y + 0.0721923154 * c.z,
            0.0193308187 * c.x + 0.1191947798 * c.y + 0.9505321522 * c.z};
}
DVec3 rec709FromXyz(const DVec3& c) {
    return {3.2409699419 * c.x - 1.5373831776 * c.y - 0.4986107603 * c.z,
            -0.9692436363 * c.x + 1.8759675015 * c.y + 0.0415550574 * c.z,
            0.0556300797 * c.x - 0.2039769589 * c.y + 1.0569715142 * c.z};
}

}  // namespace

Vec2 kelvinChromaticity(float kelvin) { return Vec2(xyOf(uvOfKelvin(kelvin))); }

Rgb kelvinTint(float kelvin) {
    const DVec2 xy = xyOf(uvOfKelvin(kelvin));
    const Rgb colour = glm::max(Rgb(rec709FromXyz({xy.x / xy.y, 1, (1 - xy.x - xy.y) / xy.y})), Rgb(0));
    return colour / luminance(colour);
}

NearestKelvin nearestKelvin(const Rgb& colour) {
    const DVec3 xyz = xyzFromRec709(DVec3(glm::max(colour, Rgb(0))));
    const double sum = xyz.x + xyz.y + xyz.z;
    if (!(sum > 0) || !std::isfinite(sum)) return {};
    const DVec2 wanted = uvOf({xyz.x / sum, xyz.y / sum});
    // Steps of equal visibility: reciprocal temperature.
    const auto distance = [&](double reciprocal) { return glm::distance(uvOfKelvin(1 / reciprocal), wanted); };
    const double low = 1.0 / highestKelvin, high = 1.0 / lowestKelvin;
    constexpr int steps = 40;
    int best = 0;
    for (int i = 1; i <= steps; ++i)
        if (distance(low + (high - low) * i / steps) < distance(low + (high - low) * best / steps)) best = i;
    double from = low + (high - low) * std::max(0, best - 1) / steps,
           to = low + (high - low) * std::min(steps, best + 1) / steps;
    for (int i = 0; i < 40; ++i) {
        const double a = from + (to - from) / 3, b = to - (to - from) / 3;
        (distance(a) < distance(b) ? to : from) = distance(a) < distance(b) ? b : a;
    }
    return {float(2 / (from + to)), float(distance((from + to) / 2))};
}

}  // namespace relamp
