// The environment on matte surfaces that move: vertices of parts that are no emitters. Their visibility is traced anew
// at every move.
#pragma once
#include "relight/live/matte.h"

namespace relamp {

class LiveCarried {
public:
    explicit LiveCarried(const LiveGrid& grid) : grid_(grid) {}
    /// The carried vertices of the present geometry, all stale.
    void setVertices(const LiveVertices& vertices);
    size_t count() const { return vertex_.size(); }
    size_t bytes() const { return masks_.size(); }
    /// One ray for four cells at all stale vertices.
    void coarse(const LiveVertices& vertices, const LiveOccluders& occluders, Progress& progress);
    /// One batch at the resolution of the bake; false when nothing is left.
    bool refine(const LiveVertices& vertices, const LiveOccluders& occluders, Progress& progress);
    /// Light per vertex, as LiveMatte::apply.
    void apply(const LiveVertices& vertices, const LiveLight& light, bool all, std::span<Rgb> out);
    /// Quarters the vertex sees.
    void seenNow(uint32_t vertex, std::span<uint8_t> masks) const;
    std::vector<uint32_t> takeChanged();

private:
    const LiveGrid& grid_;
    std::vector<uint32_t> vertex_, placeOf_;
    std::vector<uint8_t> masks_, level_, changed_, told_;
    std::span<uint8_t> masksOf(size_t i) {
        return std::span(masks_).subspan(i * grid_.nibbleBytes(), grid_.nibbleBytes());
    }
    void trace(const LiveVertices& vertices, const LiveOccluders& occluders, size_t i, bool coarse);
};

}  // namespace relamp
