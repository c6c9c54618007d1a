#include "image/direction_grid.h"

#include "base/parallel.h"
#include "image/mirrored_cell.h"

namespace relamp {

Vec3 squareToSphere(const Vec2& point) {
    const float u = 2 * point.x - 1, v = 2 * point.y - 1;
    const float d = 1 - (std::abs(u) + std::abs(v)), r = 1 - std::abs(d);
    const float phi = r == 0 ? 0 : (std::abs(v) - std::abs(u)) / r * (pi / 4) + pi / 4;
    const float f = r * std::sqrt(std::max(0.0f, 2 - r * r));
    return {std::copysign(f * std::cos(phi), u), std::copysign(f * std::sin(phi), v), std::copysign(1 - r * r, d)};
}

Vec2 sphereToSquare(const Vec3& direction) {
    const float x = std::abs(direction.x), y = std::abs(direction.y), z = std::abs(direction.z);
    const float r = std::sqrt(std::max(0.0f, 1 - z));
    float phi = std::atan2(y, x) * (2 / pi);
    float v = phi * r, u = r - v;
    if (direction.z < 0) {
        const float swap = u;
        u = 1 - v;
        v = 1 - swap;
    }
    u = std::copysign(u, direction.x);
    v = std::copysign(v, direction.y);
    const auto unit = [](float t) { return std::clamp(t * 0.5f + 0.5f, 0.0f, 1.0f); };
    return {unit(u), unit(v)};
}

Rgb interpolated(const std::vector<Rgb>& cells, const DirectionGrid& grid, const Vec3& direction) {
    const Vec2 p = sphereToSquare(direction * grid.axes) * float(grid.side) - Vec2(0.5f);
    const int x = int(std::floor(p.x)), y = int(std::floor(p.y));
    const float fx = p.x - float(x), fy = p.y - float(y);
    Rgb sum(0);
    for (int dy = 0; dy < 2; ++dy)
        for (int dx = 0; dx < 2; ++dx)
            sum += (dx ? fx : 1 - fx) * (dy ? fy : 1 - fy) * cells[size_t(mirroredCell(x + dx, y + dy, grid.side))];
    return sum;
}

namespace {
constexpr double brightOverMean = 4;
constexpr int outgoingPoints = 8;  // a side of a cell
}  // namespace

std::vector<Rgb> turnedCells(const std::vector<Rgb>& cells, const DirectionGrid& from, const DirectionGrid& to,
                             int points) {
    const auto inside = [](int k, int parts) {
        return Vec2(float(k % parts) + 0.5f, float(k / parts) + 0.5f) / float(parts);
    };
    // What stands out is scattered, the rest is gathered: a point that is fetched too often or not at all must not be a
    // sun.
    double mean = 0;
    for (const Rgb& c : cells) mean += double(maxChannel(c)) / double(cells.size());
    const float bright = float(brightOverMean * mean);
    std::vector<Rgb> even(cells);
    for (Rgb& c : even)
        if (const float most = maxChannel(c); most > bright) c *= bright / most;
    std::vector<Rgb> out(size_t(to.cells()));
    parallelFor(out.size(), 256, [&](size_t c) {
        Rgb sum(0), low(0), high(0);
        const auto fetch = [&](int parts) {
            sum = Rgb(0);
            for (int k = 0; k < parts * parts; ++k) {
                const Rgb& there = even[size_t(from.cellOf(to.direction(int(c), inside(k, parts))))];
                low = k ? glm::min(low, there) : there;
                high = k ? glm::max(high, there) : there;
                sum += there;
            }
            out[c] = sum / float(parts * parts);
        };
        fetch(std::max(1, points / 2));
        if (points > 1 && glm::any(glm::lessThan(low, 0.95f * high))) fetch(points);
    });
    const double fraction = double(to.cells()) / double(from.cells()) / double(outgoingPoints * outgoingPoints);
    for (size_t c = 0; c < cells.size(); ++c) {
        if (cells[c] == even[c]) continue;
        const Rgb part = float(fraction) * (cells[c] - even[c]);
        for (int k = 0; k < outgoingPoints * outgoingPoints; ++k)
            out[size_t(to.cellOf(from.direction(int(c), inside(k, outgoingPoints))))] += part;
    }
    return out;
}

}  // namespace relamp
