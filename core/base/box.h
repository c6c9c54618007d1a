// Axis-aligned bounds.
#pragma once
#include <limits>

#include "base/math.h"

namespace relamp {

/// Bounds of points. An empty box has its minimum at +infinity and its maximum at -infinity, and its
/// centre and diagonal are 0.
template <class V>
struct BoxOf {
    V min = V(std::numeric_limits<typename V::value_type>::infinity());
    V max = -V(std::numeric_limits<typename V::value_type>::infinity());

    bool empty() const { return !(min.x <= max.x); }
    void grow(const V& point) {
        min = glm::min(min, point);
        max = glm::max(max, point);
    }
    /// Moves every side out by `margin`.
    void widen(typename V::value_type margin) {
        min -= margin;
        max += margin;
    }
    V centre() const { return empty() ? V(0) : typename V::value_type(0.5) * (min + max); }
    V size() const { return max - min; }
    /// Length from corner to corner.
    typename V::value_type diagonal() const { return empty() ? 0 : glm::length(max - min); }
    bool contains(const V& point) const {
        return glm::all(glm::greaterThanEqual(point, min)) && glm::all(glm::lessThanEqual(point, max));
    }
};

using Box = BoxOf<Vec3>;
using DBox = BoxOf<DVec3>;

/// Bounds of all the points of a list.
template <class V>
BoxOf<V> boxOf(const std::vector<V>& points) {
    BoxOf<V> box;
    for (const V& p : points) box.grow(p);
    return box;
}

}  // namespace relamp
