// Deterministic sample points: a counter-based hash and low-discrepancy sequences. No hidden state, so the same
// bits whatever the thread count. Seeds are options.
#pragma once
#include <cstdint>

#include "base/math.h"

namespace relamp {

/// Mixes 64 bits (the finaliser of SplitMix64).
inline uint64_t mixBits(uint64_t x) {
    x += 0x9e3779b97f4a7c15ull;
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ull;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebull;
    return x ^ (x >> 31);
}
/// A float in [0, 1) from the upper 24 bits.
inline float unitFloat(uint64_t bits) { return float(bits >> 40) * 0x1p-24f; }

/// The n-th point of the R2 sequence (additive recurrence with the plastic number) shifted by `shift`, in [0,1)^2.
inline Vec2 r2Point(uint32_t n, const Vec2& shift) {
    const double x = shift.x + n * 0.7548776662466927, y = shift.y + n * 0.5698402909980532;
    return {std::min(float(x - std::floor(x)), 0x1.fffffep-1f), std::min(float(y - std::floor(y)), 0x1.fffffep-1f)};
}
/// A random shift for the sequences above, from a seed and two counters.
inline Vec2 randomShift(uint64_t seed, uint64_t a, uint64_t b) {
    const uint64_t h = mixBits(mixBits(mixBits(seed) ^ a) ^ b);
    return {unitFloat(h), unitFloat(mixBits(h))};
}
/// A cosine-weighted direction about +Z from a point of the unit square (concentric disc).
inline Vec3 cosineHemisphere(const Vec2& u) {
    const float a = 2 * u.x - 1, b = 2 * u.y - 1;
    float r = 0, phi = 0;
    if (a * a > b * b) {
        r = a;
        phi = pi / 4 * (b / a);
    } else if (b != 0) {
        r = b;
        phi = pi / 2 - pi / 4 * (a / b);
    }
    const float x = r * std::cos(phi), y = r * std::sin(phi);
    return {x, y, std::sqrt(std::max(0.0f, 1 - x * x - y * y))};
}

}  // namespace relamp
