// The direction square of live transport. Each cell is cut in four: which quarters a vertex sees is one nibble of its visibility.
#pragma once
#include <array>
#include <span>
#include <vector>

#include "image/direction_grid.h"

namespace relamp {

class LiveGrid {
public:
    explicit LiveGrid(int side);
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

    /// Share of a Lambert surface's light that comes from each cell's quarters: cosine x solid angle / pi, scaled so that all quarters above the
    /// horizon together give 1. `masks`: four bits a cell, two cells a byte. Cost: a microsecond at side 32.
    void weights(const Vec3& normal, std::span<const uint8_t> masks, std::span<float> weight) const;
    /// That of single quarters of one cell, `scale` from weightScale() of the same normal.
    float weightOf(const Vec3& normal, size_t cell, unsigned mask, float scale) const;
    float weightScale(const Vec3& normal) const;
    /// Calls found(cell) for every cell that may meet the cone about `axis`, in a fixed order.
    template <class Found>
    void cellsInCone(const Vec3& axis, float angle, Found&& found) const {
        const float cosine = std::cos(angle), sine = std::sin(angle);
        for (const Parent& p : parents_) {
            if (!p.cap.meets(axis, angle, cosine, sine)) continue;
            for (size_t row = 0; row < side_; ++row)
                for (size_t column = 0; column < side_; ++column) {
                    const size_t c = p.first + row * size_t(grid_.side) + column;
                    if (cap_[c].meets(axis, angle, cosine, sine)) found(c);
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
        bool meets(const Vec3& otherAxis, float angle, float otherCosine, float otherSine) const {
            return angle + radius >= pi || glm::dot(axis, otherAxis) >= cosine * otherCosine - sine * otherSine;
        }
    };
    struct Parent {
        Cap cap;
        size_t first;  // its upper left cell
    };
    DirectionGrid grid_;
    size_t side_ = 4;  // cells along a side of a parent
    std::vector<Cap> cap_;
    std::array<std::vector<float>, 4> x_, y_, z_;  // of the quarters' middles
    std::vector<uint16_t> order_;
    std::vector<Parent> parents_;
};

inline unsigned nibbleOf(const uint8_t* masks, size_t cell) { return masks[cell / 2] >> (4 * (cell % 2)) & 15u; }
inline void setNibble(uint8_t* masks, size_t cell, unsigned value) {
    const unsigned shift = 4 * (cell % 2);
    masks[cell / 2] = uint8_t((masks[cell / 2] & ~(15u << shift)) | (value << shift));
}

}  // namespace relamp
