// The surface of a set of voxels.
#pragma once
#include <vector>

#include "scene/mesh.h"

namespace relamp {

struct Voxel {
    int x = 0, y = 0, z = 0;
    auto operator<=>(const Voxel&) const = default;
};

/// Voxels in groups of those that touch, corners too. Groups in the order of their first voxel; `voxels` ascending and
/// without repetition. O(voxels log voxels).
std::vector<std::vector<Voxel>> touchingVoxels(const std::vector<Voxel>& voxels);

struct VoxelSurface {
    std::vector<Vec3> positions;
    std::vector<Triangle> triangles;  ///< counter-clockwise from outside
};

/// Where occupancy, smoothed over a voxel to either side, is `level`, by surface nets [Gibson98]. Voxel (0, 0, 0) has
/// its centre at `origin`. Closed. O(box of the voxels); empty where that is larger than 4e7.
VoxelSurface voxelSurface(const std::vector<Voxel>& voxels, const Vec3& origin, float side, float level);

}  // namespace relamp
