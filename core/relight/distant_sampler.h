// Where to look for distant light from one surface point: cells in proportion to radiance x cosine. What is left to
// chance is visibility, so a few dozen rays suffice for a pixel.
#pragma once
#include <vector>

#include "relight/distant_light.h"

namespace relamp {

/// Draws directions from the environment for a given normal. The proposal is built per normal in one pass over 1024
/// coarse cells; inside a coarse cell the finest cells are drawn in proportion to their radiance.
class DistantSampler {
public:
    explicit DistantSampler(const DistantLight& light);

    /// Working memory of one thread: the proposal for the current normal.
    struct Proposal {
        Vec3 normal{2};  // not a unit vector: no proposal yet
        std::vector<float> cumulative;
        std::vector<float> weight;
        float total = 0;
    };
    /// Prepares `proposal` for a normal; keeps it when the normal is the same within 2 degrees. False: no light can
    /// arrive.
    bool prepare(const Vec3& normal, Proposal& proposal) const;
    Vec3 sample(const Proposal& proposal, const Vec2& u) const;
    /// Density per steradian of sample().
    float density(const Proposal& proposal, const Vec3& direction) const;

private:
    const DistantLight& light_;
    DirectionGrid coarse_{32};
    int fineSide_ = 1;             // fine cells along one side of a coarse cell
    std::vector<uint32_t> order_;  // coarse cells along a Morton curve: neighbours stay together
    std::vector<Vec3> direction_;  // per place in that order
    std::vector<float> energy_;
    std::vector<uint32_t> placeOf_;      // coarse cell -> place
    std::vector<float> fineCumulative_;  // per coarse cell (by place), its fine cells
    std::vector<uint32_t> fineCell_;
};

}  // namespace relamp
