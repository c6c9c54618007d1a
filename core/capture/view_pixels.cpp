#include "capture/view_pixels.h"

#include <cmath>

namespace relamp {

std::optional<Rgb> radianceAt(const View& view, const Vec2& place, bool clippedToo) {
    const float fx = place.x - 0.5f, fy = place.y - 0.5f;
    const int x = int(std::floor(fx)), y = int(std::floor(fy));
    if (x < 0 || y < 0 || x + 1 >= view.image.width || y + 1 >= view.image.height) return {};
    Rgb sum(0);
    for (int k = 0; k < 4; ++k) {
        const int px = x + (k & 1), py = y + (k >> 1);
        const Rgb& pixel = view.image.at(px, py);
        if (!view.image.usableAt(px, py)) return {};
        if (!clippedToo && view.saturation > 0 && maxChannel(pixel) >= view.saturation) return {};
        const float right = fx - float(x), down = fy - float(y);
        sum += ((k & 1) ? right : 1 - right) * ((k >> 1) ? down : 1 - down) * pixel;
    }
    return glm::max(sum, Rgb(0));
}

}  // namespace relamp
