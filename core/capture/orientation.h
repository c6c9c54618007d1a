// relamp's world has Z up. Captures whose files say otherwise are turned while they are read, and files that are wrong about
// themselves can be set right without touching them.
#pragma once
#include <string>

#include "capture/capture.h"

namespace relamp {

/// What the user says against the files. Kept in the shot, so that it opens the same way.
struct CaptureFix {
    std::string up;            ///< "x", "-y", ...: the axis that is up in the files; empty: as they say
    bool flipCameras = false;  ///< the matrices have OpenCV's axes (Y down, looks along +Z) though they should have OpenGL's
    bool operator==(const CaptureFix&) const = default;
};

/// Unit vector of "x", "y", "z" with an optional sign; throws Error for anything else.
Vec3 axisFromName(const std::string& name);
/// The rotation by a multiple of 90 degrees that takes the axis `up` to +Z; exact.
Mat3 rotationToZUp(const Vec3& up);
/// Turns mesh and cameras so that the file's `up` becomes +Z, and flips the cameras' axes when asked. Fills capture.up and worldFromFile.
void orientCapture(Capture& capture, const Vec3& up, bool flipCameras);

}  // namespace relamp
