// The distant environment of a frame: piecewise constant on the equal-area square.
#pragma once
#include <memory>
#include <vector>

#include "image/direction_grid.h"

namespace relamp {

struct Backdrop;

class DistantLight {
public:
    /// `cells` = mean radiance of each cell of `grid`; black is allowed. `backdrop`: what is seen of it, null: the
    /// cells.
    DistantLight(DirectionGrid grid, std::vector<Rgb> cells, std::shared_ptr<const Backdrop> backdrop = {});
    bool black() const { return black_; }
    Rgb radiance(const Vec3& direction) const { return cells_[size_t(grid_.cellOf(direction))]; }
    /// What is seen behind the scene: the backdrop's, else interpolated between cell centres. Light is gathered from
    /// radiance().
    Rgb background(const Vec3& direction) const;
    const std::shared_ptr<const Backdrop>& backdrop() const { return backdrop_; }
    const DirectionGrid& grid() const { return grid_; }
    const std::vector<Rgb>& cells() const { return cells_; }

private:
    DirectionGrid grid_;
    std::vector<Rgb> cells_;
    std::shared_ptr<const Backdrop> backdrop_;
    bool black_ = true;
};

}  // namespace relamp
