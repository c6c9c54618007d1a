// Where to look for light from one surface point: distant cells in proportion to radiance x cosine, emitter patches in
// proportion to their form factor. What is left to chance is visibility, so a few dozen rays suffice for a pixel.
#pragma once
#include <vector>

#include "relight/distant_light.h"
#include "transport/near_field.h"

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

/// Draws points on one emitter for a given surface point: at most 64 groups of neighbouring triangles, weighed by a
/// bound of what they can send.
class EmitterSampler {
public:
    explicit EmitterSampler(const EmitterSurface& surface);

    struct Proposal {
        std::vector<float> cumulative, weight;
        float total = 0;
    };
    bool prepare(const Vec3& point, const Vec3& normal, Proposal& proposal) const;
    /// A point on the emitter; `areaDensity` per square metre; its triangle (index into the surface).
    Vec3 sample(const Proposal& proposal, const Vec2& u, float& areaDensity, size_t& triangle) const;
    /// Density per square metre of drawing a point of the given triangle.
    float areaDensity(const Proposal& proposal, size_t triangle) const;

private:
    const EmitterSurface& surface_;
    struct Group {
        Vec3 centre{0}, axis{0};
        float area = 0, radius = 0, coneSine = 0;  // normals lie within the cone about the axis
        uint32_t begin = 0, end = 0;               // into order_
    };
    std::vector<Group> groups_;
    std::vector<uint32_t> order_, groupOf_;
    std::vector<float> cumulativeArea_;  // inside each group
};

}  // namespace relamp
