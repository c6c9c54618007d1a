// Reflected binary (Gray) codes with bits that are not known.
#pragma once
#include <algorithm>
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

/// What Gray bits say of which those in `unsure` (same numbering, bit 0 is the finest) are not known: the smallest
/// interval that holds the codes of all their values. Beside a stripe's edge, where it is the pattern that is half lit,
/// an unknown bit of any weight leaves two neighbouring codes, and the edge lies between them. Of more than three
/// unknown bits the coarsest counts. Intervals wider than `widest` are none.
inline CodeInterval intervalOf(uint32_t gray, uint32_t unsure, int widest) {
    uint32_t low = numberOfGray(gray), high = low;
    if (std::popcount(unsure) <= 3) {
        // Every subset of the unknown bits, flipped.
        for (uint32_t flipped = unsure; flipped; flipped = (flipped - 1) & unsure) {
            const uint32_t code = numberOfGray(gray ^ flipped);
            low = std::min(low, code);
            high = std::max(high, code);
        }
    } else {
        const int lost = std::bit_width(unsure);
        low = low >> lost << lost;
        high = low + (1u << lost) - 1;
    }
    if (high - low >= uint32_t(widest)) return {};
    return {uint16_t(low), uint16_t(high + 1)};
}

}  // namespace relamp
