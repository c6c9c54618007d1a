// Reflected binary (Gray) codes with bits that are not known.
#pragma once
#include <bit>
#include <cstdint>

namespace relamp {

inline uint32_t grayOf(uint32_t number) { return number ^ (number >> 1); }
inline uint32_t numberOfGray(uint32_t gray) {
    for (uint32_t shift = 1; shift < 32; shift *= 2) gray ^= gray >> shift;
    return gray;
}

/// Places [low, high) along an axis of the projector that a code may mean.
struct CodeInterval {
    uint16_t low = 0, high = 0;  ///< equal: not known
    int width() const { return high - low; }
    float middle() const { return 0.5f * float(low + high); }
};

/// What Gray bits say of which those in `unsure` (same numbering, bit 0 is the finest) are not known. One unknown bit
/// leaves two codes: beside a stripe's edge, where it is the pattern that is half lit, they are neighbours, and the
/// edge lies between them. Otherwise the code is as coarse as the coarsest unknown bit. Wider ones than `widest` are
/// none.
inline CodeInterval intervalOf(uint32_t gray, uint32_t unsure, int widest) {
    const uint32_t code = numberOfGray(gray);
    uint32_t low = code, high = code + 1;
    if (std::has_single_bit(unsure)) {
        const uint32_t other = numberOfGray(gray ^ unsure);
        low = std::min(code, other);
        high = std::max(code, other) + 1;
    } else if (unsure) {
        const int lost = std::bit_width(unsure);
        low = code >> lost << lost;
        high = low + (1u << lost);
    }
    if (high - low > uint32_t(widest)) return {};
    return {uint16_t(low), uint16_t(high)};
}

}  // namespace relamp
