#include "shot/ratio_frame.h"

#include "display/display_image.h"

namespace relamp {
bool showsSameSurface(const Frame& a, const Frame& b, size_t p) {
    const bool none = a.depth[p] > 1e29f, other = b.depth[p] > 1e29f;
    if (none || other) return none == other;
    return glm::distance(a.position[p], b.position[p]) <= surfaceTolerance * a.depth[p];
}

float ratioFloor(const Image& photograph) { return 1e-3f / exposureFor(photograph, 99); }

void applyRatio(const RatioOptions& options, const Image& photograph, int firstRow, const Frame& captured,
                Frame& look) {
    const size_t above = size_t(firstRow) * size_t(look.width);
    for (size_t p = 0; p < look.beauty.size(); ++p) {
        const size_t at = above + p;
        if (!photograph.usable.empty() && !photograph.usable[at]) continue;
        if (!showsSameSurface(captured, look, p)) continue;
        const Rgb photo = photograph.pixels[at], before = captured.beauty[p], after = look.beauty[p];
        const bool clipped = options.saturation > 0 && maxChannel(photo) >= options.saturation;
        if (options.kind == Ratio::difference || clipped) {
            look.beauty[p] = glm::max(photo + after - before, Rgb(0));
            continue;
        }
        Rgb factor(1);
        for (int c = 0; c < 3; ++c) {
            const float old = before[c] + options.floor, next = after[c] + options.floor,
                        detail = (photo[c] + options.floor) / old;
            const float change = std::max(next / old, old / next);
            const float relit =
                next * (change > options.limit ? std::pow(detail, options.limit / change) : detail) - options.floor;
            look.beauty[p][c] = change == 1 ? photo[c] : std::max(relit, 0.0f);
            factor[c] = after[c] > 0 ? look.beauty[p][c] / after[c] : 0.0f;
        }
        look.world[p] *= factor;
        for (auto& group : look.byEmitter) group[p] *= factor;
    }
}

}  // namespace relamp
