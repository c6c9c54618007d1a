// What a photograph would show of what lies behind a point, by what the other photographs show of it.
#pragma once
#include <optional>
#include <vector>

#include "capture/capture.h"
#include "radiance/samples.h"
#include "scene/scene.h"

namespace relamp {

class SeenPast {
public:
    /// O(pixels).
    SeenPast(const Scene& scene, const Capture& capture, const RadianceSamples& samples);

    /// Difference between `shown` and what lies on the ray of `view` beyond `from` metres: mean of the channels' log
    /// ratios. The mesh there may show all that other views show of it (gloss, prints), the background what other views
    /// see of it in the same direction. None where no other view tells. O(views + ray).
    std::optional<float> difference(size_t view, const Vec3& direction, float from, const Rgb& shown) const;
    float floor() const { return floor_; }

private:
    const Scene& scene_;
    const Capture& capture_;
    const RadianceSamples& samples_;
    DirectionGrid grid_{128};
    float floor_ = 0;
    /// Per view and cell: mean radiance of the background; negative where the view does not see it.
    std::vector<std::vector<Rgb>> background_;
};

}  // namespace relamp
