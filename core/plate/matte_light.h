// Light for what a plate shows and the capture does not hold (an actor, a prop): the irradiance at its place before and
// after the edit, for six directions, and the factor that a pixel of it takes.
#pragma once
#include <array>
#include <optional>

#include "relight/frame.h"

namespace relamp {

/// Irradiance over pi (what a white matte surface shows) that faces +X, -X, +Y, -Y, +Z, -Z.
using IrradianceCube = std::array<Rgb, 6>;

/// Of the scene's light at a point, shadows of the scene included. `samples` positions of the frame renderer's samples
/// for each direction. Cost: about 6 x samples x 20 rays.
IrradianceCube irradianceCube(const RelitScene& relit, const Vec3& point, int samples, uint64_t seed);

/// For a unit normal: faces weighted by its squared components ([McTaggart04] ambient cube).
Rgb irradianceFor(const IrradianceCube& cube, const Vec3& normal);

/// What is held out, taken for an upright thing that stands where its lowest pixels meet the scene.
struct MattePlace {
    Vec3 foot{0}, middle{0};  ///< on the scene; at the matte's middle, above the foot, at the foot's depth
};

/// None where nothing is held out, or nothing of the scene lies under its lowest pixels.
std::optional<MattePlace> mattePlaceOf(const RelitScene& captured, const Camera& camera,
                                       const std::vector<float>& matte);

struct MatteLight {
    MattePlace place;
    IrradianceCube before{}, after{};
};

/// The factor for each pixel of the matte, 1 elsewhere: after / before for the normal of an upright cylinder as wide as
/// the matte's run of pixels in that row, lit as at the place's middle. At most 64, at least 1/64.
std::vector<Rgb> matteFactors(const MatteLight& light, const Camera& camera, const std::vector<float>& matte);

}  // namespace relamp
