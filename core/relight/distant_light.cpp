#include "relight/distant_light.h"

#include "relight/backdrop.h"

namespace relamp {

DistantLight::DistantLight(DirectionGrid grid, std::vector<Rgb> cells, std::shared_ptr<const Backdrop> backdrop)
    : grid_(grid), cells_(std::move(cells)), backdrop_(std::move(backdrop)) {
    for (const Rgb& c : cells_) black_ &= !(maxChannel(c) > 0);
}

Rgb DistantLight::background(const Vec3& direction) const {
    return backdrop_ ? backdrop_->radiance(direction) : interpolated(cells_, grid_, direction);
}

}  // namespace relamp
