// Distances along the rays of a camera's pixels, from the other cameras that see the same places of the projector, and
// from the projector itself.
#pragma once
#include "capture/camera.h"
#include "scan/code_match.h"

namespace relamp {

/// Distances of the surface that a camera sees. Row-major; the pixel's ray goes through its centre.
struct RangeImage {
    int width = 0, height = 0;
    std::vector<DVec3> directions;  ///< unit, world, of every pixel
    std::vector<float> distance;    ///< metres from the camera; 0: not known
    std::vector<float> gap;         ///< metres by which the rays miss each other, the largest of those used
    size_t count() const;
};

/// A view with what is found in it.
struct RangeSource {
    const Camera* camera = nullptr;
    const DecodedView* view = nullptr;
    const CodeIndex* index = nullptr;
};

struct RangeOptions {
    double mostGap = 0;  ///< metres; 0: four times the median gap of each pair, and two pixels of the other at least
};

/// What a pair of cameras, or a camera and the projector, agreed on.
struct PairFigures {
    size_t matches = 0;    ///< pixels with a place that the other sees
    size_t used = 0;       ///< of those, with a gap small enough
    double medianGap = 0;  ///< metres, of all matches
    double mostGap = 0;    ///< metres, that was allowed
};

/// For every pixel of view `self` the point of its ray that lies nearest to the rays of the other cameras and of
/// `projector`, where there is one; each counts by the angle between the rays and by the median gap of its pair.
/// `figures` gets one entry for each view (that of `self` stays empty), and one for the projector. Cost: about 2 us a
/// pixel and camera. Throws Cancelled.
RangeImage measureRange(const std::vector<RangeSource>& views, size_t self, const Camera* projector,
                        const RangeOptions& options, std::vector<PairFigures>& figures, Progress& progress);

struct Smoothing {
    double noise = 0;   ///< standard deviation of the distances before, metres
    size_t filled = 0;  ///< pixels that got a distance from those around them
};

/// Takes out what stands alone among its neighbours, and fits a plane to the distances around each pixel (`radius` to
/// each side), towards which it moves by at most 2.5 standard deviations of the noise. Pixels without a distance get
/// the plane's where distances lie on all sides of them: gaps of a few pixels close. `slope`: largest step of
/// distance from pixel to pixel of one surface, as a multiple of a pixel's size there. Cost: 0.2 us a pixel for a
/// radius of 2. Throws Cancelled.
Smoothing smoothRange(RangeImage& range, const Camera& camera, int radius, double slope, Progress& progress);

/// The largest difference between the distances of two pixels of one surface that lie `apart` pixels from each other.
inline double mostStep(const Camera& camera, double distance, double slope, double apart, double noise) {
    return slope * apart * distance / std::max(1e-9, std::min(camera.focalX, camera.focalY)) + 4 * noise;
}

}  // namespace relamp
