// A mirror ball in a photograph: its rim is found, and what it mirrors becomes a latitude-longitude image.
#pragma once
#include <optional>

#include "capture/camera.h"
#include "image/image.h"

namespace relamp {

/// A ball as its camera sees it: the rays that touch it make one angle with the axis, however it lies in the image.
struct BallRim {
    Vec3 axis{0};         ///< unit, from the camera to the ball's centre, world
    float halfAngle = 0;  ///< radians
    float support = 0;    ///< fraction of the rim where the image has an edge along it
    float offPixels = 0;  ///< robust deviation of those edges from it
};

/// About where the ball is, in pixels.
struct BallHint {
    Vec2 centre{0};
    float radius = 0;
};

/// The rim of the ball in `photograph` (linear), which `camera` took: the circle with most edges along it (Hough), or
/// that of the hint; then the widest cone that edges about it agree on, through their subpixel places, robust. Throws
/// Error when more than three fifths of the rim have no edge along it. Cost: 0.2 s a megapixel.
BallRim findBallRim(const Image& photograph, const Camera& camera, const std::optional<BallHint>& hint);

/// What the ball mirrors, by direction of the world, as if all light were distant. `usable` is 0 behind the ball, where
/// a pixel holds more than 5 degrees, and where the photograph is masked or as bright as `clip` (0: nothing is). The
/// width follows the ball's size. The ball's reflectance stays a factor on everything.
Image unwrapMirrorBall(const Image& photograph, const Camera& camera, const BallRim& rim, float clip);

/// Marks the ball's pixels, and those of its soft edge, as not usable: it is no background.
void maskBall(const Camera& camera, const BallRim& rim, Image& photograph);

}  // namespace relamp
