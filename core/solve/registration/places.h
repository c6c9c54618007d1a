// Where photographs are compared: places of the surface that several views see, and pairs of near ones.
#pragma once
#include <vector>

#include "capture/capture.h"
#include "radiance/samples.h"
#include "scene/scene.h"

namespace relamp {

/// A place in one view. `value` and what it changes with are of the present poses and shape.
struct PlaceObservation {
    uint32_t view = 0;
    float weight = 0;  ///< of the observation
    float value = 0;   ///< log luminance
    bool valid = false;
    std::array<double, 6> byPose{};  ///< by the camera's turn, radians, and by its shift over the view's depth
    double byShape = 0;              ///< per metre along the normal
    std::array<float, 6> pixels{};   ///< by a motion of the place along the camera's axes, metres: of x, then of y
};

/// Two near places; what is compared between views is the difference of their values.
struct PlacePair {
    uint32_t from = 0, to = 0;
    bool leftOut = false;  ///< measures only
};

struct Places {
    std::vector<uint32_t> vertex;
    std::vector<uint32_t> firstObservation;      ///< of each place, and the end
    std::vector<PlaceObservation> observations;  ///< by place, then view
    std::vector<PlacePair> pairs;
    float dark = 1e-6f;         ///< a fiftieth of the median luminance
    std::vector<double> depth;  ///< of each view: median distance of what it sees, metres
};

/// At most 20000 vertices that three views see, drawn by their ranks, and for each the ends of walks over two and five
/// edges. Every other cell of a grid, 15 % of the diagonal wide, is left out: a whole region, so that what gloss
/// pretends in one does not count as borne out. Clipped observations and those beside depth edges are not taken, nor
/// vertices of `mirrors` (per vertex non-zero, or empty): what these show moves with the eye.
Places choosePlaces(const Capture& capture, const Scene& scene, const RadianceSamples& samples,
                    const std::vector<uint8_t>& mirrors);

}  // namespace relamp
