#include "solve/known_patch.h"

#include <cmath>

namespace relamp {
namespace {

constexpr float contradiction = 3;    // deviations
constexpr float leastOff = 0.05f;     // what models are off by however little is told
constexpr float nothingKnown = 0.5f;  // relative; with two patches alone it does not say which is wrong
constexpr float leastDeviation = 1e-3f;

float square(float v) { return v * v; }

/// Mean of what the others that take part and the rest say, in channel c, and its deviation.
struct Others {
    float mean = 0, sigma = 0;
};
Others othersOf(const std::vector<PatchReading>& readings, const std::vector<uint8_t>& used, size_t but, int c,
                float rest) {
    float weight = 1 / square(std::max(rest, leastDeviation)), sum = 0;
    for (size_t p = 0; p < readings.size(); ++p) {
        if (p == but || !used[p]) continue;
        const float own = 1 / square(std::max(readings[p].sigma[c], leastDeviation));
        weight += own;
        sum += own * readings[p].offset[c];
    }
    return {sum / weight, 1 / std::sqrt(weight)};
}

/// By how many deviations patch p is off, in the channel in which it is most.
float contradicted(const std::vector<PatchReading>& readings, const std::vector<uint8_t>& used, size_t p) {
    size_t others = 0;
    for (size_t o = 0; o < used.size(); ++o) others += o != p && used[o];
    float worst = 0;
    for (int c = 0; c < 3; ++c) {
        const PatchReading& own = readings[p];
        if (own.restSigma[c] > nothingKnown && others < 2) continue;
        const Others told = othersOf(readings, used, p, c, own.restSigma[c]);
        const float off = std::abs(own.offset[c] - told.mean);
        if (off < leastOff) continue;
        worst = std::max(worst, off / std::hypot(std::max(own.sigma[c], leastDeviation), told.sigma));
    }
    return worst;
}

}  // namespace

std::vector<uint8_t> consistentPatches(const std::vector<PatchReading>& readings) {
    std::vector<uint8_t> used(readings.size(), 1);
    for (size_t round = 0; round < readings.size(); ++round) {
        size_t worst = 0;
        float most = contradiction;
        for (size_t p = 0; p < readings.size(); ++p) {
            const float off = used[p] ? contradicted(readings, used, p) : 0;
            if (off > most) most = off, worst = p;
        }
        if (!(most > contradiction)) break;
        used[worst] = 0;
    }
    const std::vector<uint8_t> kept = used;
    for (size_t p = 0; p < readings.size(); ++p)
        if (!kept[p] && contradicted(readings, kept, p) <= contradiction) used[p] = 1;
    return used;
}

Rgb offsetOfPatches(const std::vector<PatchReading>& readings, const std::vector<uint8_t>& used) {
    Rgb offset(0);
    for (int c = 0; c < 3; ++c) {
        float rest = 10;
        for (size_t p = 0; p < readings.size(); ++p)
            if (used[p]) rest = std::min(rest, readings[p].restSigma[c]);
        offset[c] = othersOf(readings, used, readings.size(), c, rest).mean;
    }
    return offset;
}

}  // namespace relamp
