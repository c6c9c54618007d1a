// Straight pieces of the rims of flat surfaces: where a mesh ends at the edge of a table or board.
#pragma once
#include "scene/scene.h"

namespace relamp {

/// From `from` to `to` the flat surface lies on the left, seen from above.
struct StraightRim {
    DVec3 from{0}, to{0};                       ///< metres
    DVec3 up{0, 0, 1};                          ///< unit: the flat surface's normal
    double spacing = 0;                         ///< metres: between vertices of the rim
    uint32_t surface = 0;                       ///< number of the flat surface
    bool creased = false;                       ///< the mesh goes on below it, at least in part
    bool cornerFrom = false, cornerTo = false;  ///< whether the next rim begins where this one ends

    double length() const { return glm::length(to - from); }
    DVec3 along() const { return glm::normalize(to - from); }
    /// Unit, in the plane, away from the surface.
    DVec3 out() const { return glm::cross(along(), up); }
    /// Metres beyond the edge, above the plane, and along it from `from`.
    double beyond(const DVec3& p) const { return glm::dot(p - from, out()); }
    double above(const DVec3& p) const { return glm::dot(p - from, up); }
    double at(const DVec3& p) const { return glm::dot(p - from, along()); }
};

/// How far a mesh may be off a flat surface beside its rim, metres.
double heightBesideRim(const Scene& scene);

/// Planes that hold a twentieth of the mesh's area, and the lines along their rims (RANSAC, then least squares): a
/// fifth of the surface's extent long, with rim over 30 % of it. Rims of other surfaces and crooked ones are none.
/// Vertices of `leftOut` (non-zero: lights) are of none. O(trials x vertices).
std::vector<StraightRim> straightRims(const Scene& scene, const std::vector<uint8_t>& leftOut);

/// Neighbours meet in their corner where one of their ends lies within `reach` metres of it and the other within a
/// third of its line.
void joinCorners(std::vector<StraightRim>& rims, double reach);

}  // namespace relamp
