// Ratio frames: the photograph itself relit, so that its grain and the detail no mesh has stay in the image.
#pragma once
#include "image/image.h"
#include "relight/frame.h"

namespace relamp {

enum class Ratio {
    none,
    quotient,   ///< photograph x new / old
    difference  ///< photograph + (new - old)
};

struct RatioOptions {
    Ratio kind = Ratio::none;
    /// Where the light changes by more than this factor the photograph's own deviation from the model counts less and
    /// less: brightened, its noise would grow as well; darkened, the edges of what was bright would stay behind.
    float limit = 8;
    float floor = 0;       ///< radiance that counts as black: keeps quotients finite
    float saturation = 0;  ///< photograph values from here on are clipped; 0: none
};

/// Surfaces are the same within this fraction of the depth.
inline constexpr float surfaceTolerance = 2e-3f;

/// Whether both frames show the same surface at pixel `p`: none, or positions within that.
bool showsSameSurface(const Frame& a, const Frame& b, size_t p);

/// A floor for a photograph: 1e-3 of its 99th percentile of luminance. Cost: one sort of its pixels.
float ratioFloor(const Image& photograph);

/// Turns rows of the new model into the relit photograph, in place. With old, new = the models' radiance (as captured;
/// of the look) and p = the photograph's, all plus the floor, a pixel becomes
///     quotient    new (p / old)^w,  w = min(1, limit old / new, limit new / old):  p new / old up to the limit; p
///     itself where nothing changes difference  max(0, p + new - old)
/// The light groups are multiplied by the same factor (quotient) or stay (difference). Where the look shows another
/// surface than the photograph (position off by more than 0.2 % of the depth), where the photograph is not usable, the
/// model stays; where it is clipped the difference is taken. `firstRow`: of `look` and `captured` in the photograph.
void applyRatio(const RatioOptions& options, const Image& photograph, int firstRow, const Frame& captured, Frame& look);

}  // namespace relamp
