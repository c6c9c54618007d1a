#include "image/panorama.h"

#include <glm/gtc/packing.hpp>

#include "base/parallel.h"
#include "image/environment_map.h"

namespace relamp {
namespace {

constexpr float mostOfHalf = 65504;

/// Means of 2 x 2 texels.
Image halved(const Image& fine) {
    Image out(fine.width / 2, fine.height / 2);
    parallelFor(size_t(out.height), 16, [&](size_t row) {
        const int y = int(row);
        for (int x = 0; x < out.width; ++x)
            out.at(x, y) = 0.25f * (fine.at(2 * x, 2 * y) + fine.at(2 * x + 1, 2 * y) + fine.at(2 * x, 2 * y + 1) +
                                    fine.at(2 * x + 1, 2 * y + 1));
    });
    return out;
}

}  // namespace

Panorama::Panorama(Image latLong, int mostWidth) {
    while (latLong.width > mostWidth && latLong.height > 1) latLong = halved(latLong);
    width_ = latLong.width;
    height_ = latLong.height;
    float brightest = 0;
    for (const Rgb& texel : latLong.pixels) brightest = std::max(brightest, maxChannel(texel));
    scale_ = std::max(1.0f, brightest / mostOfHalf);
    halves_.resize(3 * latLong.pixels.size());
    parallelFor(latLong.pixels.size(), 1 << 14, [&](size_t i) {
        const Rgb texel = glm::clamp(latLong.pixels[i] / scale_, Rgb(0), Rgb(mostOfHalf));
        for (size_t k = 0; k < 3; ++k) halves_[3 * i + k] = glm::packHalf1x16(texel[int(k)]);
    });
}

Rgb Panorama::at(int x, int y) const {
    x %= width_;
    if (x < 0) x += width_;
    const size_t first = 3 * (size_t(std::clamp(y, 0, height_ - 1)) * size_t(width_) + size_t(x));
    return scale_ * Rgb(glm::unpackHalf1x16(halves_[first]), glm::unpackHalf1x16(halves_[first + 1]),
                        glm::unpackHalf1x16(halves_[first + 2]));
}

Rgb Panorama::radiance(const Vec3& direction) const {
    const Vec2 p = latLongFromDirection(direction) * Vec2(float(width_), float(height_)) - 0.5f;
    const int x = int(std::floor(p.x)), y = int(std::floor(p.y));
    const float fx = p.x - float(x), fy = p.y - float(y);
    return (1 - fy) * ((1 - fx) * at(x, y) + fx * at(x + 1, y)) +
           fy * ((1 - fx) * at(x, y + 1) + fx * at(x + 1, y + 1));
}

Image Panorama::image() const {
    Image out(width_, height_);
    for (int y = 0; y < height_; ++y)
        for (int x = 0; x < width_; ++x) out.at(x, y) = at(x, y);
    return out;
}

}  // namespace relamp
