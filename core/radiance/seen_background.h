// How bright the background is that photographs show.
#pragma once
#include "radiance/samples.h"

namespace relamp {

/// Largest channel of each direction cell that four pixels and more show; empty where that is less than a hundredth of
/// all.
inline std::vector<float> seenBackground(const RadianceSamples& samples) {
    std::vector<float> seen;
    for (size_t c = 0; c < samples.background.size(); ++c)
        if (samples.backgroundPixels[c] >= 4) seen.push_back(maxChannel(samples.background[c]));
    if (seen.size() * 100 <= samples.background.size()) seen.clear();
    return seen;
}

}  // namespace relamp
