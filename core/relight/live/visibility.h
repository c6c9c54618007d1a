// Which quarter cells of the direction square a vertex sees, by rays, and lists of cells for what changes later.
#pragma once
#include <functional>

#include "relight/live/grid.h"
#include "relight/live/parts.h"

namespace relamp {

/// Which of up to 8 rays are blocked: bit i.
using Occluded8 = std::function<uint32_t(std::span<const Ray>)>;

/// Fills the masks of one vertex (grid.nibbleBytes() bytes). One ray a cell; where neighbouring cells differ, one a
/// quarter. Quarters below the horizon of `normal` are not seen. `coarse`: one ray for four cells. Cost: about 700 rays
/// at side 32, coarse 130.
void traceCells(const LiveGrid& grid, const Vec3& origin, const Vec3& normal, bool coarse, const Occluded8& occluded,
                std::span<uint8_t> masks);

/// Cells of a run of vertices: vertex i of the run has entries start[i] ... start[i + 1] - 1, each cell x 16 + mask of
/// its quarters.
struct CellLists {
    std::vector<uint32_t> start;
    std::vector<uint16_t> entries;
    void clear(size_t vertices) {
        start.assign(vertices + 1, 0);
        entries.clear();
    }
    std::span<const uint16_t> of(size_t i) const {
        return start.empty() ? std::span<const uint16_t>()
                             : std::span<const uint16_t>(entries).subspan(start[i], start[i + 1] - start[i]);
    }
};

/// Cells of a cone and what answered for each, kept from one vertex for the next ones beside it.
struct ConeAnswers {
    Vec3 axis{0};
    float angle = -1;  ///< none
    std::vector<uint16_t> cells;
    std::vector<uint8_t> quarters, blocked;  ///< per cell: what traceCone was asked for, and what of it is blocked
};

/// The quarters of `among` (masks of one vertex) inside the cone that `occluded` blocks, appended as entries. `coarse`:
/// a ray a cell stands for its quarters, in wide cones a ray for four or sixteen cells. True when every quarter above
/// the horizon that meets the cone is in `among`. `keep`: takes the answers.
bool traceCone(const LiveGrid& grid, const Vec3& origin, const Vec3& normal, const Vec3& axis, float angle,
               std::span<const uint8_t> among, bool coarse, const Occluded8& occluded, std::vector<uint16_t>& entries,
               ConeAnswers* keep = nullptr);

/// The same from the answers of a vertex that sees the cone a small part of a cell elsewhere, without rays; false where
/// they do not do, `entries` is then as it was. `whole`: what traceCone returns.
bool coneFromAnswers(const LiveGrid& grid, const Vec3& normal, const Vec3& axis, float angle,
                     std::span<const uint8_t> among, const ConeAnswers& answers, std::vector<uint16_t>& entries,
                     bool& whole);

}  // namespace relamp
