// How a light probe was fitted to a capture, as the shot reports it.
#pragma once
#include <string>

#include "base/math.h"

namespace relamp {

struct ProbeFit {
    static constexpr float mostNoise = 0.6f;   ///< above it a probe has no say
    static constexpr float usualNoise = 0.2f;  ///< above it a probe is warned of
    static constexpr float leastNoise = 0.03f;
    static constexpr float unknownNoise = 0.1f;  ///< where nothing tells

    std::string name;  ///< of the probe's file
    std::string by;    ///< "background", or "camera" where only its camera tells how it lies; empty: nothing
    bool used = false;
    float yawDegrees = 0;     ///< counter-clockwise from above, as --env-yaw turns it
    float yawSigma = 0;       ///< degrees; 0: it was known
    Rgb gain{1};              ///< radiance of the light found over the probe's
    float gainSigma = 0;      ///< relative; 0: nothing but the solve tells it
    float measuredNoise = 0;  ///< relative deviation of a patch of 7 degrees from the background that photographs show
    float noise = 0;          ///< that its rows have: the same, or more where the shading contradicts it
    float held = 0;           ///< fraction of all directions that it holds
    float compared = 0;       ///< fraction of all directions that it was compared in
    float residual = 0;       ///< of the light found from the probe, relative, weighted by what the surfaces receive
    bool contradicted = false;  ///< the shading of the surfaces asked for more noise than it was compared with
    std::string words;          ///< one sentence: what was found
    bool doubtful() const { return !used || contradicted || noise > usualNoise; }
};

}  // namespace relamp
