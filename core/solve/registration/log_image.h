// Log luminance of a blurred photograph, at places between its pixels.
#pragma once
#include <vector>

#include "image/image.h"

namespace relamp {

/// Pixels that do not count are left out of the blur; a place where they weigh more than a tenth has no value.
class LogImage {
public:
    /// `sigma`: of the Gaussian, pixels of the photograph made smaller by the whole number `factor`. `floor` is added
    /// to the luminance, so that noise in the dark counts little. Cost O(pixels * sigma).
    LogImage(const Image& image, int factor, float sigma, float floor);

    /// Value and its slope per pixel.
    struct At {
        float value = 0;
        Vec2 slope{0};
        bool valid = false;
    };
    /// At a position in the photograph; the slope is per pixel of it.
    At at(const Vec2& pixel) const;

private:
    size_t index(int x, int y) const { return size_t(y) * size_t(width_) + size_t(x); }
    int factor_ = 1, width_ = 0, height_ = 0;
    std::vector<float> value_;
};

}  // namespace relamp
