#include "solve/albedo/above_white.h"

#include "base/statistics.h"

namespace relamp {
namespace {

constexpr float whiteAlbedo = 0.95f, aboveUsual = 1.2f, surelyAbove = 1.2f;
constexpr float unknown = 30;  // standard deviations as a multiple of the irradiance

/// The albedo of the scene's whitest surfaces, with room for light that is found too weak.
float mostAlbedo(const MatteObservations& matte, const std::vector<Rgb>& irradiance) {
    std::vector<float> needed;
    needed.reserve(irradiance.size());
    for (size_t i = 0; i < irradiance.size(); ++i)
        if (glm::all(glm::greaterThan(irradiance[i], Rgb(0))))
            needed.push_back(maxChannel(matte.radiance[i] / irradiance[i]));
    return needed.empty() ? whiteAlbedo : std::max(whiteAlbedo, aboveUsual * quantileOf(std::move(needed), 0.9));
}

}  // namespace

std::vector<Rgb> reflectedAtMost(const MatteObservations& matte, const std::vector<Rgb>& irradiance,
                                 const std::vector<uint32_t>& component) {
    const float most = mostAlbedo(matte, irradiance);
    std::vector<Rgb> reflected = matte.radiance;
    for (size_t i = 0; i < reflected.size(); ++i)
        if (matte.componentGlossy[component[matte.vertices[i]]] < 2)
            reflected[i] = glm::min(reflected[i], most * irradiance[i]);
    return reflected;
}

Irradiance unsureAboveWhite(const MatteObservations& matte, Irradiance irradiance) {
    const float most = surelyAbove * mostAlbedo(matte, irradiance.value);
    for (size_t i = 0; i < irradiance.value.size(); ++i) {
        const Rgb most3 = most * (irradiance.value[i] + irradiance.sigma[i]);
        if (glm::any(glm::greaterThan(matte.radiance[i], most3)))
            irradiance.sigma[i] = glm::max(irradiance.sigma[i], unknown * irradiance.value[i]);
    }
    return irradiance;
}

}  // namespace relamp
