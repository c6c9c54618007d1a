// A patch of known albedo in a photograph of the capture: a grey card, a grey ball, a chart.
#pragma once
#include <string>

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
};

}  // namespace relamp
