// The distant environment of a frame: piecewise constant on the equal-area square.
#pragma once
#include <vector>

#include "image/direction_grid.h"

namespace relamp {

class DistantLight {
public:
    /// `cells` = mean radiance of each cell of `grid`; black is allowed.
    DistantLight(DirectionGrid grid, std::vector<Rgb> cells);
    bool black() const { return black_; }
    Rgb radiance(const Vec3& direction) const { return cells_[size_t(grid_.cellOf(direction))]; }
    /// Interpolated between cell centres, for the background behind the scene: light is gathered from radiance().
    Rgb smoothRadiance(const Vec3& direction) const;
    const DirectionGrid& grid() const { return grid_; }
    const std::vector<Rgb>& cells() const { return cells_; }

private:
    DirectionGrid grid_;
    std::vector<Rgb> cells_;
    bool black_ = true;
};

}  // namespace relamp
