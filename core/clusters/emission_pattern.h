// How an emitter that does not shine evenly shines over its surface, as photographs show it directly.
#pragma once
#include <memory>
#include <vector>

#include "scene/scene.h"

namespace relamp {

struct EmitterCluster;
struct VertexRadiance;

/// A factor on an emitter's mean radiance for every point of its surface, equal for all channels and directions. It is
/// kept on a lattice of cubes, 16 along the longest side of the emitter but no finer than its vertices, and linear
/// between their corners.
class EmissionPattern {
public:
    /// `levels`: at these points, on the captured surface, metres; both of equal length. Corners take the value of a
    /// plane fitted to the points around them; of more than 20000 points every n-th counts. Cost: a pass over the
    /// points for each of at most 4913 corners.
    EmissionPattern(std::vector<Vec3> points, std::vector<float> levels);
    /// At a point of the captured surface, metres; beyond the lattice as at its border. Above 0.
    float at(const Vec3& point) const;

private:
    Vec3 low_{0};
    float cell_ = 1;
    std::array<int, 3> corners_{1, 1, 1};  // along each axis
    std::vector<float> level_;             // x fastest

    float corner(int x, int y, int z) const;
};

/// Sets the cluster's `level` and `pattern`, and its radiance to the mean over its surface, where photographs show that
/// it does not shine evenly: its vertices differ by more than 6 % (robust standard deviation), hardly any is clipped,
/// and what is left after smoothing differs by 5 %. What a vertex at the border of the cluster or of the mesh shows
/// counts for nothing, because its pixels hold what lies past the border: it goes on as its neighbours inside do, and
/// so do unobserved ones. Balls that were fitted to photographs and proxies stay even. O(vertices of the mesh).
void takeEmissionPattern(const Scene& scene, const std::vector<VertexRadiance>& seen, EmitterCluster& cluster);

/// `pattern` from `level`, for a cluster that was read from a file.
void rebuildPattern(const Mesh& mesh, EmitterCluster& cluster);

}  // namespace relamp
