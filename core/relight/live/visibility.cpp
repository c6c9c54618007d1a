#include "relight/live/visibility.h"

#include <bit>

namespace relamp {
namespace {

/// Rays collected eight at a time, each with a place of its own.
template <class Answer>
class Packets {
public:
    Packets(const Vec3& origin, const Occluded8& occluded, Answer answer)
        : origin_(origin), occluded_(occluded), answer_(std::move(answer)) {}
    void add(const Vec3& direction, size_t place) {
        rays_[count_] = {origin_, direction, 0, 1e30f};
        place_[count_++] = place;
        if (count_ == 8) flush();
    }
    void flush() {
        if (!count_) return;
        const uint32_t blocked = occluded_({rays_, count_});
        for (uint32_t i = 0; i < count_; ++i) answer_(place_[i], blocked >> i & 1);
        count_ = 0;
    }

private:
    Vec3 origin_;
    const Occluded8& occluded_;
    Answer answer_;
    Ray rays_[8];
    size_t place_[8];
    uint32_t count_ = 0;
};

/// Quarters of a cell above the horizon.
unsigned quartersAbove(const LiveGrid& grid, size_t cell, const Vec3& normal) {
    unsigned mask = 0;
    for (int q = 0; q < 4; ++q)
        if (glm::dot(grid.quarter(cell, q), normal) > 0) mask |= 1u << q;
    return mask;
}

/// Logarithm of the side: divisions by a number the compiler does not know would cost more than the rays of small
/// cones.
unsigned bitsOf(const LiveGrid& grid) { return unsigned(std::countr_zero(unsigned(grid.grid().side))); }

/// Whether a quarter that is not among `quarters` meets the cone. One with its middle below the horizon gives next to
/// no light and does not count.
bool hiddenInCone(const LiveGrid& grid, size_t cell, unsigned quarters, const Vec3& normal, const Vec3& axis,
                  float angle) {
    const float reach = angle + 0.75f * grid.radius(cell);  // a quarter's corners are nearer than that to its middle
    if (reach >= pi) return true;
    const float cosine = std::cos(reach);
    for (int q = 0; q < 4; ++q) {
        if (quarters >> q & 1) continue;
        const Vec3 d = grid.quarter(cell, q);
        if (glm::dot(d, normal) > 0 && glm::dot(d, axis) > cosine) return true;
    }
    return false;
}

constexpr uint8_t below = 2;  // beside 0: seen, 1: blocked

}  // namespace

void traceCells(const LiveGrid& grid, const Vec3& origin, const Vec3& normal, bool coarse, const Occluded8& occluded,
                std::span<uint8_t> masks) {
    thread_local std::vector<uint8_t> state, above;
    state.assign(grid.cells(), below);
    above.assign(grid.cells(), 0);
    std::fill(masks.begin(), masks.end(), uint8_t(0));
    Packets first(origin, occluded, [&](size_t cell, bool blocked) { state[cell] = blocked; });
    const size_t side = size_t(grid.grid().side);
    const unsigned sideBits = bitsOf(grid);
    for (const uint16_t c : grid.packetOrder()) {
        const float height = glm::dot(grid.centre(c), normal);
        if (height < -grid.radius(c)) continue;
        above[c] = height > grid.radius(c) ? uint8_t(15) : uint8_t(quartersAbove(grid, c, normal));
        if (!above[c]) continue;
        if (coarse && height > 0 && ((c % side) % 2 || (c / side) % 2)) continue;
        if (above[c] == 15) {
            first.add(grid.centre(c), c);
        } else {
            // A cell across the horizon: its highest quarter stands for the others, which see little.
            int best = 0;
            for (int q = 1; q < 4; ++q)
                if (glm::dot(grid.quarter(c, q), normal) > glm::dot(grid.quarter(c, best), normal)) best = q;
            first.add(grid.quarter(c, best), c);
        }
    }
    first.flush();
    if (coarse)
        for (size_t c = 0; c < grid.cells(); ++c) {
            if (!above[c] || state[c] != below) continue;
            const size_t leader = (c / side) / 2 * 2 * side + (c % side) / 2 * 2;
            state[c] = state[leader] == below ? uint8_t(0) : state[leader];
        }
    const auto differs = [&](size_t c) {
        const size_t x = c & (side - 1), y = c >> sideBits;
        for (size_t j = y > 0 ? y - 1 : 0; j <= std::min(y + 1, side - 1); ++j)
            for (size_t i = x > 0 ? x - 1 : 0; i <= std::min(x + 1, side - 1); ++i)
                if (state[j * side + i] != below && state[j * side + i] != state[c]) return true;
        return false;
    };
    Packets second(origin, occluded, [&](size_t place, bool blocked) {
        if (!blocked) setNibble(masks.data(), place / 4, nibbleOf(masks.data(), place / 4) | 1u << (place % 4));
    });
    for (const uint16_t c : grid.packetOrder()) {
        if (!above[c]) continue;
        if (!coarse && differs(c)) {
            for (int q = 0; q < 4; ++q)
                if (above[c] >> q & 1) second.add(grid.quarter(c, q), size_t(c) * 4 + size_t(q));
        } else if (!state[c]) {
            setNibble(masks.data(), c, above[c]);
        }
    }
    second.flush();
}

bool traceCone(const LiveGrid& grid, const Vec3& origin, const Vec3& normal, const Vec3& axis, float angle,
               std::span<const uint8_t> among, bool coarse, const Occluded8& occluded, std::vector<uint16_t>& entries,
               ConeAnswers* keep) {
    if (keep) *keep = {axis, -1, std::move(keep->cells), std::move(keep->quarters), std::move(keep->blocked)};
    if (glm::dot(axis, normal) < -std::sin(std::min(angle, pi / 2)) && angle < pi / 2) return false;
    thread_local std::vector<uint8_t> found;
    thread_local std::vector<uint16_t> cells;
    cells.clear();
    bool whole = true;
    if (keep) {
        keep->angle = angle;
        keep->cells.clear();
        keep->quarters.clear();
    }
    grid.cellsInCone(axis, angle, [&](size_t c) {
        const unsigned quarters = nibbleOf(among.data(), c);
        if (keep) {
            keep->cells.push_back(uint16_t(c));
            keep->quarters.push_back(uint8_t(quarters));
        }
        if (quarters) cells.push_back(uint16_t(c));
        if (whole && quarters != 15) whole = !hiddenInCone(grid, c, quarters, normal, axis, angle);
    });
    if (keep) keep->blocked.assign(keep->cells.size(), 0);
    if (cells.empty()) return false;
    found.assign(cells.size(), 0);
    if (coarse) {
        // A wide cone gets a ray for four cells, a very wide one for sixteen: the first of each square that may be seen
        // answers for the others.
        constexpr size_t few = 12, many = 160;
        const unsigned sideBits = bitsOf(grid), strideBits = cells.size() > many ? 2 : cells.size() > few ? 1 : 0;
        const uint32_t row = (1u << sideBits) - 1;
        const auto squareOf = [&](uint32_t c) {
            return (c >> sideBits >> strideBits << sideBits) + ((c & row) >> strideBits);
        };
        enum : uint8_t { unasked, open, blocked };
        thread_local std::vector<uint8_t> answer;
        answer.resize(grid.cells());
        for (const uint16_t c : cells) answer[squareOf(c)] = unasked;
        Packets packets(origin, occluded, [&](size_t square, bool hit) { answer[square] = hit ? blocked : open; });
        for (const uint16_t c : cells) {
            if (answer[squareOf(c)] != unasked) continue;
            answer[squareOf(c)] = open;
            // Across the horizon a quarter that may be seen stands for the cell.
            Vec3 d = grid.centre(c);
            if (glm::dot(d, normal) <= 0) d = grid.quarter(c, __builtin_ctz(nibbleOf(among.data(), c)));
            packets.add(d, squareOf(c));
        }
        packets.flush();
        for (size_t i = 0; i < cells.size(); ++i)
            if (answer[squareOf(cells[i])] == blocked) found[i] = uint8_t(nibbleOf(among.data(), cells[i]));
    } else {
        Packets packets(origin, occluded, [&](size_t place, bool blocked) {
            if (blocked) found[place / 4] = uint8_t(found[place / 4] | 1u << (place % 4));
        });
        for (size_t i = 0; i < cells.size(); ++i)
            for (int q = 0; q < 4; ++q)
                if (nibbleOf(among.data(), cells[i]) >> q & 1)
                    packets.add(grid.quarter(cells[i], q), i * 4 + size_t(q));
        packets.flush();
    }
    for (size_t i = 0; i < cells.size(); ++i)
        if (found[i]) entries.push_back(uint16_t(cells[i] << 4 | found[i]));
    if (keep)
        for (size_t i = 0, k = 0; i < cells.size(); ++i) {
            while (keep->cells[k] != cells[i]) ++k;
            keep->blocked[k] = found[i];
        }
    return whole;
}

bool coneFromAnswers(const LiveGrid& grid, const Vec3& normal, const Vec3& axis, float angle,
                     std::span<const uint8_t> among, const ConeAnswers& answers, std::vector<uint16_t>& entries,
                     bool& whole) {
    // Of a cell's width: where the cone looks and how wide it is.
    const float slack = 0.3f * 2 * std::sqrt(pi) / float(grid.grid().side);
    if (answers.angle < 0 || angle >= pi / 2 || std::abs(angle - answers.angle) > slack) return false;
    const Vec3 apart = axis - answers.axis;
    if (glm::dot(apart, apart) > slack * slack) return false;
    // A cell of which the other vertex saw nothing has no answer.
    for (size_t i = 0; i < answers.cells.size(); ++i)
        if (!answers.quarters[i] && nibbleOf(among.data(), answers.cells[i])) return false;
    whole = glm::dot(axis, normal) >= -std::sin(angle);
    bool any = false;
    for (size_t i = 0; i < answers.cells.size(); ++i) {
        const size_t c = answers.cells[i];
        const unsigned quarters = nibbleOf(among.data(), c);
        any |= quarters != 0;
        if (quarters && answers.blocked[i]) entries.push_back(uint16_t(c << 4 | quarters));
        if (whole && quarters != 15) whole = !hiddenInCone(grid, c, quarters, normal, axis, angle);
    }
    whole &= any;
    return true;
}

}  // namespace relamp
