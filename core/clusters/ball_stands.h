// Posts, cords and sockets that hold a ball of light: a reconstruction runs them together with the light, and they end
// before the ball that takes its place, or widen towards it. The ground below gets too much of its light then, or not
// enough.
#pragma once
#include "capture/proxy_light.h"
#include "radiance/round_sheets.h"

namespace relamp {

/// Round sleeves from stands into their balls. A stand is what of the mesh, which is without the triangles that the
/// balls replaced, ends within a radius of a ball and goes away from it as a thin tube: of one radius within 35 %, all
/// around, along an axis through the ball. A sleeve has the radius of the tube where it is whole, the upper quartile,
/// because meshes make some thin tubes thinner. It replaces what is left of the mesh within half a radius of the ball:
/// the neck of the bag that wrapped ball and stand, which is wider than the stand and hides light from the ground.
/// O(balls x vertices).
std::vector<SurfacePatch> ballStands(const Mesh& mesh, const std::vector<ProxyLight>& balls);

}  // namespace relamp
