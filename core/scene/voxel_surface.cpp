#include "scene/voxel_surface.h"

#include <algorithm>
#include <array>

namespace relamp {
namespace {

constexpr size_t largestGrid = 40'000'000;
constexpr int margin = 2;  ///< voxels about those that are occupied: the smoothing reaches one

/// Samples on a grid about the voxels.
class Grid {
public:
    explicit Grid(const std::vector<Voxel>& voxels) {
        Voxel high = voxels[0];
        low_ = voxels[0];
        for (const Voxel& v : voxels) {
            low_ = {std::min(low_.x, v.x), std::min(low_.y, v.y), std::min(low_.z, v.z)};
            high = {std::max(high.x, v.x), std::max(high.y, v.y), std::max(high.z, v.z)};
        }
        size_ = {size_t(high.x - low_.x + 1 + 2 * margin), size_t(high.y - low_.y + 1 + 2 * margin),
                 size_t(high.z - low_.z + 1 + 2 * margin)};
        if (double(size_[0]) * double(size_[1]) * double(size_[2]) > double(largestGrid)) return;
        value_.assign(size_[0] * size_[1] * size_[2], 0);
        for (const Voxel& v : voxels)
            value_[at(size_t(v.x - low_.x + margin), size_t(v.y - low_.y + margin), size_t(v.z - low_.z + margin))] = 1;
    }

    bool tooLarge() const { return value_.empty(); }
    size_t at(size_t x, size_t y, size_t z) const { return (z * size_[1] + y) * size_[0] + x; }
    float value(size_t i) const { return value_[i]; }
    const std::array<size_t, 3>& size() const { return size_; }
    size_t stride(size_t axis) const { return axis == 0 ? 1 : axis == 1 ? size_[0] : size_[0] * size_[1]; }
    /// Of a sample, in voxels from voxel (0, 0, 0).
    Vec3 place(size_t x, size_t y, size_t z) const {
        return Vec3(float(x) - margin + float(low_.x), float(y) - margin + float(low_.y),
                    float(z) - margin + float(low_.z));
    }

    /// 1 2 1 along each axis.
    void smooth() {
        for (size_t axis = 0; axis < 3; ++axis) {
            const size_t step = stride(axis);
            std::vector<float> next(value_.size(), 0);
            for (size_t i = step; i + step < value_.size(); ++i)
                next[i] = 0.25f * (value_[i - step] + value_[i + step]) + 0.5f * value_[i];
            value_.swap(next);
        }
    }

private:
    Voxel low_;
    std::array<size_t, 3> size_{};
    std::vector<float> value_;
};

/// The point of a cell of eight samples: mean of where its edges cross the level.
Vec3 crossingsMean(const Grid& grid, size_t x, size_t y, size_t z, float level) {
    Vec3 sum(0);
    int crossings = 0;
    const std::array<size_t, 3> corner{x, y, z};
    for (size_t axis = 0; axis < 3; ++axis)
        for (size_t k = 0; k < 4; ++k) {
            std::array<size_t, 3> from = corner;
            from[(axis + 1) % 3] += k & 1;
            from[(axis + 2) % 3] += k >> 1;
            const size_t i = grid.at(from[0], from[1], from[2]);
            const float a = grid.value(i) - level, b = grid.value(i + grid.stride(axis)) - level;
            if ((a > 0) == (b > 0)) continue;
            Vec3 p = grid.place(from[0], from[1], from[2]);
            p[int(axis)] += a / (a - b);
            sum += p;
            ++crossings;
        }
    return sum / float(std::max(1, crossings));
}

}  // namespace

std::vector<std::vector<Voxel>> touchingVoxels(const std::vector<Voxel>& voxels) {
    std::vector<std::vector<Voxel>> groups;
    std::vector<uint8_t> visited(voxels.size(), 0);
    std::vector<size_t> reached;
    for (size_t seed = 0; seed < voxels.size(); ++seed) {
        if (visited[seed]) continue;
        visited[seed] = 1;
        reached.assign(1, seed);
        for (size_t i = 0; i < reached.size(); ++i) {
            const Voxel v = voxels[reached[i]];
            for (int k = 0; k < 27; ++k) {
                const Voxel beside{v.x + k % 3 - 1, v.y + k / 3 % 3 - 1, v.z + k / 9 - 1};
                const auto found = std::lower_bound(voxels.begin(), voxels.end(), beside);
                if (found == voxels.end() || *found != beside || visited[size_t(found - voxels.begin())]) continue;
                visited[size_t(found - voxels.begin())] = 1;
                reached.push_back(size_t(found - voxels.begin()));
            }
        }
        std::sort(reached.begin(), reached.end());
        std::vector<Voxel>& group = groups.emplace_back();
        for (const size_t i : reached) group.push_back(voxels[i]);
    }
    return groups;
}

VoxelSurface voxelSurface(const std::vector<Voxel>& voxels, const Vec3& origin, float side, float level) {
    VoxelSurface surface;
    if (voxels.empty()) return surface;
    Grid grid(voxels);
    if (grid.tooLarge()) return surface;
    grid.smooth();
    const auto& [nx, ny, nz] = grid.size();
    std::vector<uint32_t> pointOf(nx * ny * nz, ~0u);  // of the cell whose first corner it is
    for (size_t z = 0; z + 1 < nz; ++z)
        for (size_t y = 0; y + 1 < ny; ++y)
            for (size_t x = 0; x + 1 < nx; ++x) {
                int inside = 0;
                for (size_t k = 0; k < 8; ++k)
                    inside += grid.value(grid.at(x + (k & 1), y + (k >> 1 & 1), z + (k >> 2))) > level;
                if (inside == 0 || inside == 8) continue;
                pointOf[grid.at(x, y, z)] = uint32_t(surface.positions.size());
                surface.positions.push_back(origin + side * crossingsMean(grid, x, y, z, level));
            }
    for (size_t z = 1; z + 1 < nz; ++z)
        for (size_t y = 1; y + 1 < ny; ++y)
            for (size_t x = 1; x + 1 < nx; ++x)
                for (size_t axis = 0; axis < 3; ++axis) {
                    const size_t i = grid.at(x, y, z), step = grid.stride(axis);
                    const bool in = grid.value(i) > level, next = grid.value(i + step) > level;
                    if (in == next) continue;
                    const size_t u = grid.stride((axis + 1) % 3), v = grid.stride((axis + 2) % 3);
                    const std::array<uint32_t, 4> p{pointOf[i - u - v], pointOf[i - v], pointOf[i], pointOf[i - u]};
                    if (in) {
                        surface.triangles.push_back({p[0], p[1], p[2]});
                        surface.triangles.push_back({p[0], p[2], p[3]});
                    } else {
                        surface.triangles.push_back({p[0], p[2], p[1]});
                        surface.triangles.push_back({p[0], p[3], p[2]});
                    }
                }
    return surface;
}

}  // namespace relamp
