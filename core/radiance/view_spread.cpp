#include "radiance/view_spread.h"

#include <cmath>

namespace relamp {

float viewSpread(const RadianceSamples& samples, uint32_t vertex, uint32_t state) {
    float sum = 0, squares = 0, weight = 0;
    int count = 0;
    for (uint32_t k = samples.start[vertex]; k < samples.start[vertex + 1]; ++k) {
        const RadianceSample& s = samples.samples[k];
        if (s.weight < 0.3f || s.clipped || samples.stateOf(s.view) != state) continue;
        const float y = luminance(s.radiance);
        sum += s.weight * y;
        squares += s.weight * y * y;
        weight += s.weight;
        ++count;
    }
    if (count < 2 || !(sum > 0)) return -1;
    const float mean = sum / weight,
                variance = std::max(0.0f, squares / weight - mean * mean) * float(count) / float(count - 1);
    if (mean < 4 * samples.noiseFloor) return -1;
    const float noise = samples.sigma(mean) / mean;
    return std::sqrt(std::max(0.0f, variance / (mean * mean) - noise * noise));
}

}  // namespace relamp
