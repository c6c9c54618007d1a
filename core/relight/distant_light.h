// The distant environment ready for sampling: piecewise constant on the equal-area square, drawn in proportion to luminance.
#pragma once
#include <vector>

#include "image/direction_grid.h"

namespace relamp {

class DistantLight {
public:
    /// `cells` = mean radiance of each cell of `grid`; black is allowed.
    DistantLight(DirectionGrid grid, std::vector<Rgb> cells);
    bool black() const { return total_ <= 0; }
    Rgb radiance(const Vec3& direction) const { return cells_[size_t(grid_.cellOf(direction))]; }
    /// A direction from a point of the unit square; its density per steradian is density(direction).
    Vec3 sample(const Vec2& u) const;
    float density(const Vec3& direction) const;
    const DirectionGrid& grid() const { return grid_; }
    const std::vector<Rgb>& cells() const { return cells_; }

private:
    DirectionGrid grid_;
    std::vector<Rgb> cells_;
    std::vector<float> cumulative_;  ///< running sum of weights, along a curve that keeps neighbours together
    std::vector<uint32_t> order_;    ///< cell of each place in it
    std::vector<float> weight_;      ///< per cell
    float total_ = 0;
};

}  // namespace relamp
