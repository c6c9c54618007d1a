// A straight body of light, tube, cone or box, that explains what the photographs show of an emitter: tubes, shades,
// panels, tablets and strips of which a reconstruction made a ridge, a bag or shreds.
#pragma once
#include <optional>
#include <string>

#include "clusters/emitter_sphere.h"

namespace relamp {

/// A box, or a tube or truncated cone along the first axis with flat ends.
struct EmitterBody {
    bool round = false;                 ///< a tube: half[1] == half[2] is its radius, of a cone half way along
    DVec3 centre{0};                    ///< metres
    glm::dmat3 axes{1};                 ///< columns: unit, right-handed
    DVec3 half{0};                      ///< metres along the axes
    float overlap = 0;                  ///< of outlines and silhouettes, where nothing hides them
    float mostSeen = 0, nextSeen = 0;   ///< of its silhouettes, the fraction that shows light, in the two best views
    std::vector<size_t> partOnly = {};  ///< of the outlines, those that show a part of it, as if something hid the rest
    static constexpr double steepest = 0.9;
    double taper = 0;  ///< of a cone: its radius is 1 + taper times that where the first axis ends; up to `steepest`

    /// Radius of a tube or cone at this place along the first axis, metres.
    double radiusAt(double x) const { return half.y * (1 + taper * x / half.x); }
    /// Metres from `eye` to where the ray enters and leaves the body, blown up by `scale`; x > y: it misses.
    glm::dvec2 chord(const DVec3& eye, const DVec3& direction, double scale = 1) const;
    /// Metres of the point from the body's surface; below 0: within (up to the distance from the nearest side).
    double distance(const DVec3& point) const;
    /// Its surface with sharp edges: sides share no vertices. Edges are about a twentieth of its length, or as long as
    /// it is thick. `triangles` of `positions`. Returns the first vertex of each side. `open`: a round one without
    /// ends.
    std::vector<uint32_t> surface(std::vector<Vec3>& positions, std::vector<Triangle>& triangles,
                                  bool open = false) const;
};

/// The tube, cone or box whose silhouettes fit the outlines best: a pattern search on their overlap from coarse to
/// fine, then least squares (followOutlines); a cone only where it is clearly better than a tube, a box only where it
/// is than both. None with fewer than three views, or all within 10 degrees. `cluster`: what the mesh has of the
/// emitter, where the search begins. O(pixels about the outlines x 2000), at most 30 000 of them.
std::optional<EmitterBody> fitBody(const Scene& scene, const Capture& capture, const RadianceSamples& samples,
                                   const EmitterCluster& cluster, const std::vector<EmitterOutline>& outlines);

/// The same; if it does not explain the outlines, those that show a part of it only, a quarter at most, are taken out
/// of `outlines`, and the rest fitted again. What hides a light there the mesh need not have: a wall seen from behind.
std::optional<EmitterBody> fitUnhidden(const Scene& scene, const Capture& capture, const RadianceSamples& samples,
                                       const EmitterCluster& cluster, std::vector<EmitterOutline>& outlines);

/// Whether the body is what the outlines show: it overlaps them by 95 %, less where they are narrow, and one view shows
/// most of it.
bool explainsOutlines(const EmitterBody& body, const std::vector<EmitterOutline>& outlines);

/// "a tube of 300 x 20.0 mm", "a box of 300 x 200 x 10.0 mm", "a cone of 160 x 80.0 to 50.0 mm" (length, diameters).
std::string wordsOf(const EmitterBody& body);

}  // namespace relamp
