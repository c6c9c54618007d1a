// A patch of known albedo in a photograph of the capture: a grey card, a grey ball, a chart.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "base/math.h"

namespace relamp {

/// What the artist tells.
struct KnownPatch {
    std::string name;     ///< "chart patch 19", "grey patch in view 3"
    size_t view = 0;      ///< of the capture
    Vec2 centre{0};       ///< pixels
    float radius = 0;     ///< pixels; 0: that pixel alone
    Rgb albedo{0.18f};    ///< linear
    float noise = 0.02f;  ///< relative deviation of what is told
};

/// How the estimate agrees with it.
struct PatchFit {
    std::string name;
    Rgb told{0}, found{0};  ///< albedo
    float noise = 0;
    bool doubtful = false;  ///< they differ by more than three deviations, and by 5 %
    std::string words;
    bool used = true;  ///< false: left out, because what else is known contradicts it
};

/// What a patch says of the light, beside what else is known of it.
struct PatchReading {
    Rgb offset{0};     ///< log of the factor by which light would have to be brighter
    Rgb sigma{0};      ///< its deviation, without what the patch shares with all of the light
    Rgb restSigma{0};  ///< deviation of what else is known of the light on it, relative; 10: nothing
};

/// Which patches take part, 1 or 0. The patch that the others and what else is known contradict most is left out, in
/// one channel by more than three deviations and 5 %, and so on; one that agrees in the end comes back. Of two patches
/// that contradict each other, where nothing else tells, both stay. Cost: quadratic in their number at least.
std::vector<uint8_t> consistentPatches(const std::vector<PatchReading>& readings);

/// The log of the factor for all light that suits the patches that take part and what else is known best, per channel.
Rgb offsetOfPatches(const std::vector<PatchReading>& readings, const std::vector<uint8_t>& used);

}  // namespace relamp
