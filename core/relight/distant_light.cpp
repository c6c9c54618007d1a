#include "relight/distant_light.h"

namespace relamp {

DistantLight::DistantLight(DirectionGrid grid, std::vector<Rgb> cells) : grid_(grid), cells_(std::move(cells)) {
    for (const Rgb& c : cells_) black_ &= !(maxChannel(c) > 0);
}

Rgb DistantLight::smoothRadiance(const Vec3& direction) const {
    const int last = grid_.side - 1;
    const Vec2 p = sphereToSquare(direction) * float(grid_.side) - Vec2(0.5f);
    const int x = int(std::floor(p.x)), y = int(std::floor(p.y));
    const float fx = p.x - float(x), fy = p.y - float(y);
    Rgb sum(0);
    for (int dy = 0; dy < 2; ++dy)
        for (int dx = 0; dx < 2; ++dx) {
            // Past the square's edge the map goes on mirrored about the edge's middle.
            int cx = x + dx, cy = y + dy;
            if (cx < 0 || cx > last) {
                cx = std::clamp(cx, 0, last);
                cy = last - std::clamp(cy, 0, last);
            } else if (cy < 0 || cy > last) {
                cy = std::clamp(cy, 0, last);
                cx = last - cx;
            }
            sum += (dx ? fx : 1 - fx) * (dy ? fy : 1 - fy) * cells_[size_t(cy) * size_t(grid_.side) + size_t(cx)];
        }
    return sum;
}

}  // namespace relamp
