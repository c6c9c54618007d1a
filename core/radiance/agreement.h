// Do the photographs agree with each other on this mesh? What they say of the same vertices, before any light is solved
// for.
#pragma once
#include <vector>

#include "base/progress.h"
#include "capture/capture.h"
#include "radiance/samples.h"
#include "scene/scene.h"

namespace relamp {

/// One photograph against the median of the others at the vertices it sees. Logarithms are natural, of luminance.
struct ViewAgreement {
    float gain = 0;         ///< median of log(photograph / others): exposure differs
    float spread = 0;       ///< robust standard deviation of it about that median
    float correlation = 0;  ///< between log photograph and log others; near 0: it shows something else than they do
    size_t vertices = 0;    ///< compared
};

/// A light that turns with the camera makes one vertex differ between views as the angle between its normal and a
/// direction of the camera's does.
struct MovingLight {
    float spreadStatic = 0;  ///< standard deviation of a vertex's log radiance between views, median of the vertices
    float spreadMoving = 0;  ///< the same after n . l of the best direction l in camera axes is divided out
    Vec3 direction{0};       ///< camera axes, towards the light
    /// True when most of the difference between views goes away.
    bool found() const { return spreadStatic > 0.1f && spreadMoving < 0.6f * spreadStatic; }
};

struct PhotographAgreement {
    std::vector<ViewAgreement> views;
    MovingLight movingLight;
};

/// Cost: O(observations log views) and 2000 vertices x 300 lights. Throws Cancelled.
PhotographAgreement photographAgreement(const Capture& capture, const Scene& scene, const RadianceSamples& samples,
                                        Progress& progress);

/// Median of a vertex's observations, channel by channel, without those of view `without`; none where no view is left.
std::optional<Rgb> medianObservation(const RadianceSamples& samples, uint32_t vertex, uint32_t without = ~0u);

}  // namespace relamp
