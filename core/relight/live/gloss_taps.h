// Light of the environment in glossy lobes, sixteen directions at a time: taps of the lobe into a pyramid of the
// environment, each as blurred as its tap is wide, and its few brightest cells one by one, because taps of a lobe
// seldom meet a sun.
#pragma once
#include <span>

#include "brdf/basis.h"
#include "relight/distant_light.h"
#include "relight/live/grid.h"

namespace relamp {

/// The environment at every resolution down from its own to 1 cell, and its brightest cells apart.
class EnvironmentPyramid {
public:
    static constexpr size_t lanes = 16, mostSuns = 64;
    EnvironmentPyramid() = default;
    explicit EnvironmentPyramid(const DistantLight& distant);
    bool black() const { return black_; }
    /// What of single cells outshines the rest of the environment, padded to whole lanes with black ones.
    struct Suns {
        std::vector<float> x, y, z;  ///< direction
        std::vector<Rgb> power;      ///< excess radiance x solid angle
        std::vector<Vec2> square;
        size_t count = 0;
    };
    const Suns& suns() const { return suns_; }

    int side() const { return side_; }
    int levels() const { return int(start_.size()); }
    /// The cells of a level, 0 the finest: (side >> level) + 2 a row, a rim of what lies beyond the square's edges
    /// about them. The suns are taken out.
    const Vec4* level(int level) const { return &cells_[start_[size_t(level)]]; }

private:
    int side_ = 0;
    std::vector<size_t> start_;
    std::vector<Vec4> cells_;
    Suns suns_;
    bool black_ = true;
};

/// The most even set of points for a given number, as the sampler of visible normals takes them.
struct TapPattern {
    explicit TapPattern(int count);  ///< a multiple of 16
    int count;
    std::vector<float> across, rest, along;  ///< x = r cos, sqrt(1 - x^2), r sin
};

struct LobeWeight {
    uint8_t lobe;
    Rgb weight;
};

/// Integral of lobes x cosine x environment x visibility. `toWorld`: frame of the normal; `eye`: unit, in that frame;
/// `masks`: the quarters seen. The same pattern at every vertex: neighbours differ by the light alone and nothing
/// flickers. Cost: about 10 ns a tap.
Rgb tapEnvironment(const EnvironmentPyramid& environment, const BrdfBasis& basis, std::span<const LobeWeight> lobes,
                   const TapPattern& pattern, const Mat3& toWorld, const Vec3& eye, const LiveGrid& grid,
                   const uint8_t* masks);

}  // namespace relamp
