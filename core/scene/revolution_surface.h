// Surfaces of revolution with a straight profile (cylinders, cones, frustums): shades, posts, cups, tins.
#pragma once
#include <optional>
#include <span>

#include "scene/scene.h"

namespace relamp {

struct RevolutionSurface {
    DVec3 centre{0};        ///< on the axis, at height 0, metres
    DVec3 axis{0, 0, 1};    ///< unit
    DVec3 across{1, 0, 0};  ///< unit, at right angles to the axis: angle 0
    double radius = 0;      ///< at height 0, metres
    double slope = 0;       ///< of the radius over the height

    double height(const DVec3& p) const { return glm::dot(p - centre, axis); }
    double angle(const DVec3& p) const;
    double radiusAt(double height) const { return radius + slope * height; }
    /// Metres from the surface, positive outside.
    double distance(const DVec3& p) const;
    DVec3 at(double height, double angle) const;
    /// Unit, away from the axis.
    DVec3 normal(double angle) const;
    DVec3 normalAt(const DVec3& p) const;  ///< the same, by a point near the surface
    /// Distances along a ray where it meets the surface, nearer one first; none where it misses it.
    std::optional<std::pair<double, double>> meets(const DVec3& eye, const DVec3& direction) const;
};

/// The open end of a surface of revolution, which stands as its rim does.
struct RimCircle {
    RevolutionSurface surface;
    double height = 0;  ///< of the rim, metres along the surface's axis
    double inner = 0;   ///< metres: radius of its inner edge, to which the inside is seen; 0: not known
    double outer = 0;   ///< metres: radius of its outer edge; 0: not known
};

/// The surface through points with normals, by least squares: the axis is the direction in which the normals differ
/// least, its place where lines along the normals meet it. None where normals do not tell an axis (planes, balls).
/// O(points).
std::optional<RevolutionSurface> fitRevolution(std::span<const DVec3> positions, std::span<const DVec3> normals);

struct FoundRevolution {
    RevolutionSurface surface;
    std::vector<uint32_t> vertices;  ///< of the scene that lie on it
    double low = 0, high = 0;        ///< metres: heights between which they lie
};

/// The surface of revolution that has the largest area of the mesh (RANSAC, then least squares). Vertices of `taken`
/// are of others. O(trials x vertices).
std::optional<FoundRevolution> findRevolution(const Scene& scene, const std::vector<uint8_t>& taken, float tolerance);

}  // namespace relamp
