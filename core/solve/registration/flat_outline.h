// Where a flat emitter's front lies, by its outlines: seen from all sides they agree at its own depth alone.
#pragma once
#include <optional>
#include <vector>

#include "capture/capture.h"
#include "clusters/emitter_sphere.h"

namespace relamp {

struct FlatOutline {
    DVec3 first{0}, second{0};   ///< unit, across the normal
    double front = 0, back = 0;  ///< metres along the normal, from the place
    std::vector<double> shape;  ///< metres from the place to the edge, evenly in angles from `first` to `second` and on
    double deviation = 0;       ///< standard deviation of `front`, metres
    double residual = 0;        ///< median, pixels
    size_t views = 0;           ///< that took part

    /// Metres from the place to the edge, towards a point `x` along `first` and `y` along `second`.
    double edgeTowards(double x, double y) const;
};

/// A slab with the normal `normal`, whose front and back have one shape: a distance from `place` in each of 96
/// directions across it. A boundary point of an outline lies on the front's edge where the view does not see the side
/// below it, else on the back's. Robust least squares of distances in the photographs, smooth in the directions. Views
/// that look at it from behind or at less than 20 degrees take no part; none with fewer than four. A view counts as
/// three independent measurements, because cameras are off as a whole. O(points + 96^3).
std::optional<FlatOutline> fitFlatOutline(const Capture& capture, const std::vector<EmitterOutline>& outlines,
                                          const DVec3& place, const DVec3& normal);

}  // namespace relamp
