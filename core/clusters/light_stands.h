// Posts, cords and sockets that hold a light: a reconstruction runs them together with the light, and they end before
// the body that takes its place, or widen towards it. The ground below gets too much of its light then, or not enough.
#pragma once
#include <optional>

#include "capture/proxy_light.h"
#include "clusters/emitter_body.h"
#include "radiance/round_sheets.h"
#include "scene/straight_tube.h"

namespace relamp {

/// A ball of light, or a straight body.
struct HeldLight {
    DVec3 centre{0};                  ///< metres
    double size = 0;                  ///< metres: a ball's radius, the middle one of a body's half lengths
    std::optional<EmitterBody> body;  ///< none: a ball

    static HeldLight of(const ProxyLight& ball);
    static HeldLight of(const EmitterBody& body);
    /// Metres of a point from its surface; below 0: within.
    double distance(const DVec3& p) const;
    /// A ball's centre; of a body the place in its box that is nearest.
    DVec3 anchor(const DVec3& p) const;
};

/// What holds a light.
struct LightStand {
    StraightTube tube;          ///< as the mesh has it, away from the light; `from`: where it is whole
    HeldLight light;            ///< that it holds
    bool around = false;        ///< the mesh has it all around; else photographs must show it
    std::vector<uint32_t> bag;  ///< triangles within half a size of the light: the neck of the bag that wrapped both
};

/// Stands of a light. A stand is what of the mesh comes within a size of it and goes away from it as a thin tube: of
/// one radius within 35 %, along an axis through the ball or the body. Of what lies within half a size no
/// shape is asked: it may be gone, or the bag that wraps both. The tube's radius is the upper quartile, because meshes
/// make some thin tubes thinner. O(triangles).
std::vector<LightStand> lightStands(const Mesh& mesh, const HeldLight& light);

/// How far a mesh is a tube about the axis, metres along it from `from` on: in pieces of one and a half radii most
/// vertices within four radii of the axis lie within 2.2. O(triangles).
double tubeEnd(const Mesh& mesh, const StraightTube& tube);

/// A round sleeve from the light's inside to where the tube is whole, in place of the bag, which is wider than the
/// stand and hides light from the ground.
SurfacePatch sleeveOf(const Mesh& mesh, const LightStand& stand);

/// The whole stand as photographs show it (fitTube), in place of the mesh's. `ground`: metres along it to a surface
/// that it stands on, if that is known.
SurfacePatch wholeStandOf(const Mesh& mesh, const LightStand& stand, const StraightTube& measured,
                          std::optional<double> ground = {});

}  // namespace relamp
