// What photographs of one scene differ by without the scene having changed: exposure, white balance, the lens's
// fall-off. Automatic cameras change the first two from one photograph to the next.
#pragma once
#include <string>
#include <vector>

#include "capture/camera.h"

namespace relamp {

struct View;

/// Radiance = pixel / (gain x falloff). Gains have a geometric mean of 1 in each channel.
struct PhotometricFix {
    struct ViewGain {
        std::string view;  ///< View::name
        Rgb gain{1};
        bool operator==(const ViewGain&) const = default;
    };
    std::vector<ViewGain> gains{};  ///< views that are not named have 1
    /// The lens lets through exp(falloff2 r^2 + falloff4 r^4), r = 0 in the middle of the image and 1 in its corners.
    float falloff2 = 0, falloff4 = 0;
    bool empty() const { return gains.empty() && falloff2 == 0 && falloff4 == 0; }
    Rgb gainOf(const std::string& view) const;
    float falloffAt(float radiusSquared) const;
    bool operator==(const PhotometricFix&) const = default;
};

/// Squared distance of a pixel position from the middle of the image, 1 in the corners.
float radiusSquared(const Camera& camera, const Vec2& pixel);

/// Brings a view's pixels and its clip level to the common exposure; where the lens darkens the corners, clipped pixels
/// stay clipped. O(pixels).
void applyPhotometric(const PhotometricFix& fix, View& view);

}  // namespace relamp
