// Texels from the pixels that cover them, pass by pass, under light that is known at the vertices.
#pragma once
#include <atomic>
#include <bit>
#include <optional>

#include "base/progress.h"
#include "capture/capture.h"
#include "scene/scene.h"
#include "solve/estimate.h"
#include "texture/atlas.h"
#include "texture/photograph_geometry.h"

namespace relamp {

/// Positions in pixels that a pass looks at; of more pixels it looks at every so many.
constexpr double mostTexelSamples = 1.2e7;
/// Four positions in each pixel, which are kept; else one, at its centre.
inline bool keepsSamples(double pixels) { return 4 * pixels <= mostTexelSamples; }

/// Sums that atomic integers add up: in any order the same bits. Two of 32 bits share one word.
class TexelSums {
public:
    TexelSums(size_t texels, float samplesPerTexel)
        : unit_(32768 / std::max(1.0f, samplesPerTexel / 100)), sums_(texels * 2, 0) {}
    void clear() { std::fill(sums_.begin(), sums_.end(), 0); }
    void add(size_t texel, float weight, const Rgb& difference) {
        put(texel * 2, weight, weight * difference.x);
        put(texel * 2 + 1, weight * difference.y, weight * difference.z);
    }
    void prefetch(size_t texel) const { __builtin_prefetch(&sums_[texel * 2], 1); }
    float weight(size_t texel) const { return float(high(sums_[texel * 2])) / unit_; }
    Rgb difference(size_t texel) const {
        const uint64_t one = sums_[texel * 2], two = sums_[texel * 2 + 1];
        return Rgb(float(low(one)), float(high(two)), float(low(two))) / unit_;
    }

private:
    float unit_;
    std::vector<uint64_t> sums_;
    /// The nearest integer, of a value below 2^22.
    static int64_t rounded(float value) {
        constexpr float shift = 12582912;  // 1.5 x 2^23: there a unit is the last digit
        return std::bit_cast<int32_t>(value + shift) - std::bit_cast<int32_t>(shift);
    }
    static int32_t low(uint64_t sums) { return int32_t(uint32_t(sums)); }
    static int32_t high(uint64_t sums) { return int32_t(uint32_t((sums - uint64_t(int64_t(low(sums)))) >> 32)); }
    void put(size_t at, float higher, float lower) {
        const uint64_t both = (uint64_t(rounded(higher * unit_)) << 32) + uint64_t(rounded(lower * unit_));
        std::atomic_ref<uint64_t>(sums_[at]).fetch_add(both, std::memory_order_relaxed);
    }
};

/// What one position in a pixel sees.
struct TexelSample {
    Vec2 place;
    Rgb light{0};
};

/// A pixel that sees one surface, lit by light that is known.
struct TracedPixel {
    uint32_t view = 0;
    int x = 0, y = 0;
    Rgb light{0}, coating{0};  ///< mean of its positions
    Rgb byVertices{0};         ///< radiance without coating, from the vertices' albedo
    float weight = 0;          ///< trust in the pixel and in its light, in [0, 1]
    uint32_t triangle = 0;     ///< that its first position meets
    std::array<TexelSample, 4> samples;
};

/// On one chart: squares of what vertices miss in pixels, of what texels add, and their product. Roots of radiance.
struct DetailEvidence {
    double missing = 0, both = 0, detail = 0;
    DetailEvidence& operator+=(const DetailEvidence& other) {
        missing += other.missing;
        both += other.both;
        detail += other.detail;
        return *this;
    }
    /// Squared error where `fraction` of the detail is kept.
    double errorWith(double fraction) const { return missing - 2 * fraction * both + fraction * fraction * detail; }
};

/// Keeps references to what it is made from. One thread calls it; it uses all cores itself.
class TextureSolver {
public:
    /// `texture`: with texels that come from the vertices. `inside`: texels whose centres lie on a triangle.
    /// `geometry`: with triangles, where positions are not kept, or these are traced anew in each pass. Advances
    /// `progress` by one a view where positions are kept.
    TextureSolver(const Capture& capture, const Scene& scene, const Estimate& estimate, AlbedoTexture& texture,
                  const std::vector<uint8_t>& inside, const std::vector<PhotographGeometry>& geometry,
                  Progress& progress);

    /// One pass over the pixels of the views that `used` marks. Advances `progress` by one a view.
    void pass(const std::vector<uint8_t>& used, int index, TexelSums& sums, Progress& progress);

    /// What texels say beside vertices in a view that they were not made from, added to the evidence on each chart.
    void judge(uint32_t view, const Atlas& atlas, std::vector<DetailEvidence>& charts) const;

    /// Keeps in `texture` that fraction of what the texels of each chart say beside the vertices.
    void keepDetail(const Atlas& atlas, const std::vector<float>& fraction, AlbedoTexture& texture) const;

    /// AlbedoTexture::confidence after the passes. `fraction`: of each chart's detail that is kept; empty: all.
    std::vector<uint8_t> confidence(const Atlas& atlas, const std::vector<float>& fraction) const;

    float samplesPerTexel() const { return samplesPerTexel_; }

private:
    const Capture& capture_;
    const Scene& scene_;
    const Estimate& estimate_;
    AlbedoTexture& texture_;
    const std::vector<uint8_t>& inside_;
    const std::vector<PhotographGeometry>& geometry_;
    std::vector<Rgb> start_;
    std::vector<uint16_t> seen_;                    // per texel: pixels of all passes so far, of 64; saturated
    int passes_ = 0;                                // so far
    std::vector<std::vector<TracedPixel>> traced_;  // per view, where all fit into memory
    int across_ = 1;                                // positions along a pixel's side
    uint32_t turns_ = 1;                            // passes until every pixel has had its turn
    float samplesPerTexel_ = 1, dark_ = 0;

    void followInside(const TexelSums& sums);
    void blend(const TracedPixel& p, std::array<TexelBlend, 4>& blends) const;
    Rgb byTexture(const TracedPixel& p, const std::array<TexelBlend, 4>& blends) const;
    /// What the corners of a triangle say in one view; kept from pixel to pixel.
    struct LitTriangle {
        uint32_t triangle = Hit::none;
        float trust = 0;  ///< in its light; 0: no texels, or no light that is known
        std::array<Rgb, 3> white{}, albedo{}, coating{};
        std::array<Vec3, 3> corners{};
    };
    /// A row of a view, from left to right.
    struct TracedRow {
        TracedRow(const PhotographGeometry& geometry, int row);
        int y;
        std::optional<TriangleRuns::Row> known;
        LitTriangle seen{};
    };
    int firstOf(int y, int turn) const;
    void look(uint32_t view, uint32_t triangle, LitTriangle& seen) const;
    bool hits(uint32_t view, int x, TracedRow& row, Hit* found) const;
    bool trace(uint32_t view, int x, TracedRow& row, TracedPixel& p) const;
};

}  // namespace relamp
