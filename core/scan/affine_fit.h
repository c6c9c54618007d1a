// Weighted least squares of an affine function of two coordinates.
#pragma once
#include <algorithm>
#include <optional>

namespace relamp {

/// Sums over points; `Value`: double, or a vector of doubles.
template <class Value>
struct AffineFit {
    double w = 0, x = 0, y = 0, xx = 0, xy = 0, yy = 0;
    Value v{0}, xv{0}, yv{0};

    struct Plane {
        Value at, alongX, alongY;  ///< at the origin, and a step along either coordinate
    };

    void add(double px, double py, const Value& value, double weight = 1) {
        w += weight;
        x += weight * px;
        y += weight * py;
        xx += weight * px * px;
        xy += weight * px * py;
        yy += weight * py * py;
        v += weight * value;
        xv += weight * px * value;
        yv += weight * py * value;
    }

    /// None where the points lie on a line, their determinant below `least` of the square of their spread.
    std::optional<Plane> solved(double least = 1e-3) const {
        if (!(w > 0)) return std::nullopt;
        const double mx = x / w, my = y / w;
        const Value mv = v / w;
        const double sxx = xx / w - mx * mx, sxy = xy / w - mx * my, syy = yy / w - my * my;
        const double spread = sxx + syy, determinant = sxx * syy - sxy * sxy;
        if (!(determinant > least * spread * spread) || !(spread > 1e-9)) return std::nullopt;
        const Value sxv = xv / w - mx * mv, syv = yv / w - my * mv;
        const Value b = (syy * sxv - sxy * syv) / determinant, c = (sxx * syv - sxy * sxv) / determinant;
        return Plane{mv - b * mx - c * my, b, c};
    }
};

}  // namespace relamp
