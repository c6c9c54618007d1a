// The direction square of live transport. Each cell is cut in four: which quarters a vertex sees is one nibble of its
// visibility.
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "image/direction_grid.h"

namespace relamp {

class LiveGrid {
public:
    explicit LiveGrid(int side);  ///< 4 or more, a power of two
    const DirectionGrid& grid() const { return grid_; }
    size_t cells() const { return cap_.size(); }
    size_t nibbleBytes() const { return cells() / 2; }  ///< of one vertex
    const Vec3& centre(size_t cell) const { return cap_[cell].axis; }
    Vec3 quarter(size_t cell, int q) const { return {x_[size_t(q)][cell], y_[size_t(q)][cell], z_[size_t(q)][cell]}; }
    float radius(size_t cell) const { return cap_[cell].radius; }  ///< radians: from the centre to the farthest corner
    /// Cells by neighbourhoods of 4 x 2, so that packets of rays stay together.
    const std::vector<uint16_t>& packetOrder() const { return order_; }
    /// The quarter of the square that holds a point of it: cell x 4 + quarter.
    size_t quarterAt(const Vec2& square) const;

    /// Fraction of a Lambert surface's light that comes from each cell's quarters: cosine x solid angle / pi, scaled so
    /// that all quarters above the horizon together give 1. `masks`: four bits a cell, two cells a byte. Cost: a
    /// microsecond at side 32.
    void weights(const Vec3& normal, std::span<const uint8_t> masks, std::span<float> weight) const;
    /// That of single quarters of one cell, `scale` from weightScale() of the same normal.
    float weightOf(const Vec3& normal, size_t cell, unsigned mask, float scale) const;
    float weightScale(const Vec3& normal) const;
    /// Calls found(cell) for every cell that may meet the cone about `axis`, in a fixed order.
    template <class Found>
    void cellsInCone(const Vec3& axis, float angle, Found&& found) const {
        const float cosine = std::cos(angle), sine = std::sin(angle);
        int32_t meets[capLanes], child[capLanes];
        for (size_t group = 0; group * capLanes < parents_.size(); ++group) {
            parentCaps_[group].meets(axis, angle, cosine, sine, meets);
            for (size_t k = 0; k < std::min(capLanes, parents_.size() - group * capLanes); ++k) {
                if (!meets[k]) continue;
                const size_t p = group * capLanes + k;
                childCaps_[p].meets(axis, angle, cosine, sine, child);
                for (size_t i = 0; i < capLanes; ++i)
                    if (child[i]) found(parents_[p] + i / 4 * size_t(grid_.side) + i % 4);
            }
        }
    }

private:
    /// A circle on the sphere.
    struct Cap {
        Vec3 axis{0, 0, 1};
        float radius = 0, cosine = 1, sine = 0;
        void setRadius(float radians) {
            radius = radians;
            cosine = std::cos(radians);
            sine = std::sin(radians);
        }
    };
    static constexpr size_t capLanes = 16;
    /// Sixteen of them side by side.
    struct Caps {
        float x[capLanes] = {}, y[capLanes] = {}, z[capLanes] = {}, radius[capLanes] = {}, cosine[capLanes] = {},
              sine[capLanes] = {};
        void set(size_t k, const Cap& c) {
            x[k] = c.axis.x;
            y[k] = c.axis.y;
            z[k] = c.axis.z;
            radius[k] = c.radius;
            cosine[k] = c.cosine;
            sine[k] = c.sine;
        }
        void meets(const Vec3& axis, float angle, float otherCosine, float otherSine, int32_t* out) const {
            for (size_t k = 0; k < capLanes; ++k)
                out[k] = int32_t(x[k] * axis.x + y[k] * axis.y + z[k] * axis.z >=
                                 cosine[k] * otherCosine - sine[k] * otherSine) |
                         int32_t(angle + radius[k] >= pi);
        }
    };
    DirectionGrid grid_;
    std::vector<Cap> cap_;
    std::array<std::vector<float>, 4> x_, y_, z_;  // of the quarters' middles
    std::vector<uint16_t> order_;
    std::vector<size_t> parents_;   // of 4 x 4 cells each: its upper left cell
    std::vector<Caps> parentCaps_;  // of sixteen parents
    std::vector<Caps> childCaps_;   // of a parent's cells
};

inline unsigned nibbleOf(const uint8_t* masks, size_t cell) { return masks[cell / 2] >> (4 * (cell % 2)) & 15u; }
inline void setNibble(uint8_t* masks, size_t cell, unsigned value) {
    const unsigned shift = 4 * (cell % 2);
    masks[cell / 2] = uint8_t((masks[cell / 2] & ~(15u << shift)) | (value << shift));
}

}  // namespace relamp
