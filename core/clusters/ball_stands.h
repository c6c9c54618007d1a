// Posts, cords and sockets that hold a ball of light: a reconstruction runs them together with the light, and they end
// before the ball that takes its place, or widen towards it. The ground below gets too much of its light then, or not
// enough.
#pragma once
#include "capture/proxy_light.h"
#include "radiance/round_sheets.h"
#include "scene/straight_tube.h"

namespace relamp {

/// What holds a ball of light.
struct BallStand {
    StraightTube tube;          ///< as the mesh has it, away from the ball; `from`: where it is whole
    DVec3 centre{0};            ///< of the ball
    double ball = 0;            ///< its radius, metres
    std::vector<uint32_t> bag;  ///< triangles within half a radius of the ball: the neck of the bag that wrapped both
};

/// Stands of balls. A stand is what of the mesh, which is without the triangles that the balls replaced, ends within a
/// radius of a ball and goes away from it as a thin tube: of one radius within 35 %, all around, along an axis through
/// the ball. The tube's radius is the upper quartile, because meshes make some thin tubes thinner. O(balls x vertices).
std::vector<BallStand> ballStands(const Mesh& mesh, const std::vector<ProxyLight>& balls);

/// How far a mesh is a tube about the axis, metres along it from `from` on: in pieces of one and a half radii most
/// vertices within four radii of the axis lie within 2.2. O(triangles).
double tubeEnd(const Mesh& mesh, const StraightTube& tube);

/// A round sleeve from the ball's inside to where the tube is whole, in place of the bag, which is wider than the stand
/// and hides light from the ground.
SurfacePatch sleeveOf(const Mesh& mesh, const BallStand& stand);

/// The whole stand as photographs show it (fitTube), in place of the mesh's.
SurfacePatch wholeStandOf(const Mesh& mesh, const BallStand& stand, const StraightTube& measured);

}  // namespace relamp
