#include "solve/light/contributions.h"

namespace relamp {

std::vector<Rgb> lightContributions(const InfluenceMatrix& rows, const Lighting& lighting, const std::vector<Rgb>& lit,
                                    const std::vector<uint32_t>& of) {
    std::vector<Rgb> fractions(lighting.leaves.size(), Rgb(0));
    for (const uint32_t r : of) {
        const Rgb inverse = 1.0f / glm::max(lit[r], Rgb(1e-30f));
        for (size_t i = 0; i < fractions.size(); ++i)
            fractions[i] += rows.row(r)[i] * lighting.leafRadiance[i] * inverse;
    }
    for (Rgb& fraction : fractions) fraction /= float(std::max<size_t>(1, of.size()));
    return fractions;
}

}  // namespace relamp
