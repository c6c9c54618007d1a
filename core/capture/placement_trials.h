// How else cameras and mesh could be meant: other units, axes and hands are tried by how well the photographs then
// agree on the surface. Inner part of the check, not a door.
#pragma once
#include <optional>
#include <vector>

#include "base/progress.h"
#include "capture/check.h"

namespace relamp {

/// How well photographs agree on the mesh where it is.
struct PlacementScore {
    float disagreement = 0;  ///< see there, stops
    double seenTwice = 0;    ///< fraction of the vertices
    double covered = 0;      ///< fraction of the images that shows the mesh, mean
};

/// The one change under which the photographs agree much better than `now`; none where they agree well as it is, where
/// nothing helps, and without photographs. `stride`: see lookAt. Cost: a second at most for a hundred thousand
/// triangles, and only where they disagree; twelve views are asked. Throws Cancelled.
std::optional<PlacementAdvice> betterPlacement(const Capture& capture, const std::vector<uint8_t>& referenced,
                                               size_t stride, const PlacementScore& now, Progress& progress);

}  // namespace relamp
