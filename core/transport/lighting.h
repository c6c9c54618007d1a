// The unknown of the lighting problem: distant radiance on the leaves of a quadtree over the direction square, and one
// radiance per emitter. A tree-structured set of Haar coefficients spans the same functions, so these are the paper's
// wavelet coefficients, and non-negativity is an exact bound per leaf (docs/method.md 2).
#pragma once
#include "base/error.h"
#include "base/math.h"
#include "image/direction_grid.h"
#include "wavelet/coefficients.h"

namespace relamp {

/// A square of the quadtree: side 2^level squares across, position (x, y).
struct Leaf {
    uint8_t level = 0;
    uint16_t x = 0, y = 0;
    uint8_t environment = 0;  ///< whose part it is, of the environments of the lighting states
    float solidAngle() const { return 4 * pi / float(1u << (2 * level)); }
};

/// The leaves of one environment, or of several: each has a quadtree of its own, and all leaves stand in one list.
/// `environmentOfState` says, per lighting state, which environment it has; -1: none, and empty: all states have one.
class LightLeaves {
public:
    static constexpr int maxLevel = 8;  ///< side 256, 0.8 degrees
    /// All leaves at one level.
    static LightLeaves uniform(int level, const Mat3& axes = Mat3(1), const std::vector<int>& environmentOfState = {});
    /// The leaves of quadtrees in the given order. Throws Error when they do not cover each square, each part once.
    static LightLeaves of(const std::vector<Leaf>& leaves, const Mat3& axes = Mat3(1),
                          const std::vector<int>& environmentOfState = {});
    /// Replaces leaf `i` by its four children (the first takes its index, the others come last). No-op at maxLevel.
    void split(size_t i);
    size_t size() const { return leaves_.size(); }
    const Leaf& operator[](size_t i) const { return leaves_[i]; }
    /// Of the square: world from its own axes (DirectionGrid::axes).
    const Mat3& axes() const { return axes_; }
    size_t environments() const { return environments_; }
    /// The same leaves, of one environment, for states of which some may have none.
    LightLeaves withStates(const std::vector<int>& environmentOfState) const;
    /// The environment of a lighting state; -1: it has none.
    int environmentOf(size_t state) const { return environmentOfState_.empty() ? 0 : environmentOfState_[state]; }
    /// Whether the light of leaf `i` reaches the scene in a lighting state.
    bool shines(size_t i, size_t state) const { return environmentOf(state) == int(leaves_[i].environment); }
    size_t leafOf(const Vec3& direction, size_t environment = 0) const;
    /// Direction of the point (u, v) in [0,1]^2 of leaf `i`.
    Vec3 direction(size_t i, const Vec2& inside) const {
        return axes_ * squareToSphere((Vec2(leaves_[i].x, leaves_[i].y) + inside) / float(1u << leaves_[i].level));
    }
    /// All pairs of leaves of one environment that touch along an edge, across the square's folded edges too.
    std::vector<std::pair<uint32_t, uint32_t>> neighbourPairs() const;
    /// Per cell of `grid` the leaf that holds its centre (grid at most as fine as maxLevel, along the same axes).
    std::vector<uint32_t> leafOfCells(const DirectionGrid& grid, size_t environment = 0) const;

private:
    std::vector<Leaf> leaves_;
    Mat3 axes_{1};
    size_t environments_ = 1;
    std::vector<int> environmentOfState_;
    std::vector<uint32_t> table_;  ///< side 256 cells -> leaf, one environment after the other
    void takeStates(const std::vector<int>& environmentOfState);
    void fillTable(uint32_t leaf);
};

struct Lighting {
    LightLeaves leaves;
    std::vector<Rgb> leafRadiance;
    std::vector<Rgb> emitterRadiance;
};

/// Haar coefficients of the function of the first environment's leaves on a grid of the given side along the leaves'
/// axes, per channel.
std::array<SparseCoefs, 3> environmentCoefs(const Lighting& lighting, int side);

}  // namespace relamp
