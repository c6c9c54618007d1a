#include "solve/shares_of_light.h"

namespace relamp {

std::vector<Rgb> sharesOfLight(const InfluenceMatrix& rows, const Lighting& lighting, const std::vector<Rgb>& lit,
                               const std::vector<uint32_t>& of) {
    std::vector<Rgb> shares(lighting.leaves.size(), Rgb(0));
    for (const uint32_t r : of) {
        const Rgb inverse = 1.0f / glm::max(lit[r], Rgb(1e-30f));
        for (size_t i = 0; i < shares.size(); ++i) shares[i] += rows.row(r)[i] * lighting.leafRadiance[i] * inverse;
    }
    for (Rgb& share : shares) share /= float(std::max<size_t>(1, of.size()));
    return shares;
}

}  // namespace relamp
