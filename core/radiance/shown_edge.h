// Rims of flat surfaces as photographs show them. Inner part of what completes surfaces, not a door.
#pragma once
#include "radiance/edge_views.h"
#include "scene/straight_rim.h"

namespace relamp {

/// The rim where photographs show an edge most clearly, to a fraction of a pixel and as far as they show it; none where
/// they show none, or a bent one. O(length / spacing x (places^2 + places x views)).
std::optional<StraightRim> shownEdge(const EdgeViews& views, StraightRim rim);

/// The edges of several rims. Two in one line are one edge where photographs show it between them as well: what a mesh
/// has there hangs out. As shownEdge, for each rim and each such pair.
std::vector<StraightRim> shownEdges(const EdgeViews& views, const std::vector<StraightRim>& rims);

}  // namespace relamp
