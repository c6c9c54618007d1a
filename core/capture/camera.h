// Cameras: pose, pinhole intrinsics, the lens models of COLMAP, and the one that Metashape and others use. Samples are
// taken at projected points, so nothing is ever undistorted.
#pragma once
#include <array>
#include <optional>
#include <string>

#include "base/math.h"

namespace relamp {

enum class LensModel {
    simplePinhole,
    pinhole,
    simpleRadial,
    radial,
    openCv,
    openCvFisheye,
    fullOpenCv,
    fov,
    simpleRadialFisheye,
    radialFisheye,
    thinPrismFisheye,
    brown  ///< Metashape's: a radial polynomial up to r^8, tangential terms, skew
};

/// COLMAP's name of a model ("OPENCV"), or "BROWN", which COLMAP does not have, and back; empty when unknown.
std::optional<LensModel> lensModelFromName(const std::string& name);
std::string lensModelName(LensModel model);

/// A posed camera. Camera axes are OpenGL's: +X right, +Y up, looks down -Z. Pixel (0,0) has its centre at (0.5, 0.5),
/// y down.
struct Camera {
    int width = 0, height = 0;                                ///< pixels
    double focalX = 0, focalY = 0, centreX = 0, centreY = 0;  ///< pixels
    LensModel model = LensModel::pinhole;
    /// Distortion in COLMAP's order for the model (k1 k2 p1 p2 k3 k4 k5 k6 / fisheye k1..k4 / FOV's omega); unused ones
    /// are 0. Of brown: k1 k2 p1 p2 k3 k4 skew, where p1 and p2 are OpenCV's and skew is in units of focalX: the
    /// image's x grows by focalX skew times the distorted y.
    std::array<double, 8> distortion{};
    DMat4 worldFromCamera{1.0};

    DVec3 position() const { return DVec3(worldFromCamera[3]); }
    /// Unit direction the camera looks in, world space.
    DVec3 forward() const { return -glm::normalize(DVec3(worldFromCamera[2])); }
    /// Whether the lens does more than project, as a pinhole or a fisheye does.
    bool isDistorted() const;
    /// Pixel position of a world point; none when it is behind the camera or outside the lens model's valid field
    /// (where the distortion stops growing with the angle). The point may fall outside the image.
    std::optional<Vec2> project(const DVec3& world) const;
    /// The lens formula alone, pixels, in double: without the test of the valid field, none behind the camera only. For
    /// comparing with what other programs state; may fold back.
    std::optional<glm::dvec2> projectByFormula(const DVec3& world) const;
    /// Unit world direction of the ray through a pixel position (distortion inverted by Newton steps to 1e-7 of a
    /// normalised unit; cost under a microsecond).
    Vec3 rayDirection(const Vec2& pixel) const;
    /// Distance along forward() of a world point, metres.
    double depthOf(const DVec3& world) const;
};

}  // namespace relamp
