// Places in space along a curve that keeps neighbours together.
#pragma once
#include <algorithm>
#include <cstdint>

#include "base/math.h"

namespace relamp {

/// Key of a point of the unit cube along a Morton curve, ten bits of each coordinate interleaved; outside counts as at
/// the border.
inline uint64_t mortonKey(const Vec3& p) {
    uint64_t key = 0;
    for (int k = 0; k < 3; ++k) {
        const uint32_t q = uint32_t(std::clamp(p[k], 0.0f, 1.0f) * 1023.0f);
        for (int bit = 0; bit < 10; ++bit) key |= uint64_t(q >> bit & 1) << (3 * bit + k);
    }
    return key;
}

}  // namespace relamp
