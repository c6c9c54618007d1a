// The weights of all lobes at one place of a surface: how readers ask for a reflectance, whatever it is stored per.
#pragma once
#include <array>
#include <vector>

#include "base/math.h"

namespace relamp {

/// Weights as they are stored now: stored[lobe][vertex], lobe 0 is Lambert.
using StoredWeights = std::vector<std::vector<Rgb>>;

/// At a vertex. Holds a reference to the stored weights.
class LobesAtVertex {
public:
    LobesAtVertex(const StoredWeights& stored, size_t vertex) : stored_(stored), vertex_(vertex) {}
    size_t size() const { return stored_.size(); }
    /// False where no lobe has a weight for it.
    bool known() const { return !stored_.empty() && vertex_ < stored_[0].size(); }
    Rgb operator[](size_t lobe) const { return stored_[lobe][vertex_]; }
    /// Of the matte part; 0 without lobes.
    Rgb albedo() const { return stored_.empty() ? Rgb(0) : stored_[0][vertex_]; }

private:
    const StoredWeights& stored_;
    size_t vertex_;
};

/// Inside a triangle, interpolated. Holds a reference to the stored weights.
class LobesAtHit {
public:
    /// `barycentric`: weights of corners 1 and 2; corner 0 has the rest.
    LobesAtHit(const StoredWeights& stored, const std::array<uint32_t, 3>& corners, const Vec2& barycentric)
        : stored_(stored),
          corners_(corners),
          fraction_(1 - barycentric.x - barycentric.y, barycentric.x, barycentric.y) {}
    size_t size() const { return stored_.size(); }
    Rgb operator[](size_t lobe) const {
        const std::vector<Rgb>& w = stored_[lobe];
        return fraction_.x * w[corners_[0]] + fraction_.y * w[corners_[1]] + fraction_.z * w[corners_[2]];
    }
    Rgb albedo() const { return stored_.empty() ? Rgb(0) : (*this)[0]; }

private:
    const StoredWeights& stored_;
    std::array<uint32_t, 3> corners_;
    Vec3 fraction_;
};

}  // namespace relamp
