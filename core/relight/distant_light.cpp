#include "relight/distant_light.h"

namespace relamp {

DistantLight::DistantLight(DirectionGrid grid, std::vector<Rgb> cells) : grid_(grid), cells_(std::move(cells)) {
    const size_t n = size_t(grid_.cells());
    weight_.resize(n);
    order_.resize(n);
    cumulative_.resize(n);
    // Morton order: nearby sample numbers give nearby directions, so low-discrepancy numbers stay stratified on the sphere.
    for (uint32_t code = 0; code < n; ++code) {
        uint32_t x = 0, y = 0;
        for (int bit = 0; bit < 16; ++bit) {
            x |= (code >> (2 * bit) & 1) << bit;
            y |= (code >> (2 * bit + 1) & 1) << bit;
        }
        order_[code] = y * uint32_t(grid_.side) + x;
    }
    double sum = 0;
    for (size_t i = 0; i < n; ++i) {
        weight_[i] = (cells_[i].x + cells_[i].y + cells_[i].z) / 3;
        if (!(weight_[i] > 0) || !std::isfinite(weight_[i])) weight_[i] = 0;
    }
    for (size_t i = 0; i < n; ++i) {
        sum += double(weight_[order_[i]]);
        cumulative_[i] = float(sum);
    }
    total_ = float(sum);
}

Vec3 DistantLight::sample(const Vec2& u) const {
    const float pick = u.x * total_;
    const size_t at = std::min(size_t(std::upper_bound(cumulative_.begin(), cumulative_.end(), pick) - cumulative_.begin()), cumulative_.size() - 1);
    const float below = at ? cumulative_[at - 1] : 0.0f, width = cumulative_[at] - below;
    const float inside = width > 0 ? std::clamp((pick - below) / width, 0.0f, 0.9999f) : 0.5f;
    return grid_.direction(int(order_[at]), Vec2(inside, u.y));
}

float DistantLight::density(const Vec3& direction) const {
    return total_ > 0 ? weight_[size_t(grid_.cellOf(direction))] / (total_ * grid_.cellSolidAngle()) : 0.0f;
}

}  // namespace relamp
