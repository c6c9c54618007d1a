// A latitude-longitude image of what is far away, for looking at: what lights the scene is a DirectionGrid.
#pragma once
#include <array>

#include "image/image.h"

namespace relamp {

/// Axes as in environment_map.h. Never changes.
class Panorama {
public:
    /// `latLong`: twice as wide as high; halved until it is at most `mostWidth` wide. Negative values become 0.
    explicit Panorama(Image latLong, int mostWidth = 8192);
    int width() const { return width_; }
    int height() const { return height_; }
    /// Radiance of a unit direction, bilinear.
    Rgb radiance(const Vec3& direction) const;
    Rgb at(int x, int y) const;
    /// Times scale() they are radiance. Three a texel, from the top left.
    const std::vector<uint16_t>& halves() const { return halves_; }
    float scale() const { return scale_; }
    Image image() const;

private:
    int width_ = 0, height_ = 0;
    float scale_ = 1;  ///< so that the brightest texel is a half float
    std::vector<uint16_t> halves_;
};

}  // namespace relamp
