// Sheets that photographs see from behind: a reconstruction closes a shade's opening and leaves no inner side.
#pragma once
#include "radiance/round_sheets.h"

namespace relamp {

/// What lies behind some triangles, over the pixels that show them or a surface from behind: parts of these pixels.
struct SeenBehind {
    float backs = 0;   ///< a surface from behind
    float fronts = 0;  ///< a surface from the front; the rest show the background
};

/// O(pixels).
SeenBehind seenBehind(const Scene& scene, const Capture& capture, const RadianceSamples& samples,
                      const std::vector<uint32_t>& triangles);

/// A ball that sends light.
struct LightBall {
    Vec3 centre{0};
    float radius = 0;  ///< metres
};

/// The second side of the sheets whose backs two views see, as they are or through `without`, and of those that the
/// balls light from behind; empty where none is. O(pixels + triangles + rays from the balls).
SurfacePatch backSides(const Scene& scene, const Capture& capture, const RadianceSamples& samples,
                       const std::vector<uint32_t>& without, const std::vector<LightBall>& lights = {});

}  // namespace relamp
