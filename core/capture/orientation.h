// relamp's world has Z up. Captures whose files say otherwise are turned while they are read, and files that are wrong
// about themselves can be set right without touching them.
#pragma once
#include <optional>
#include <string>

#include "capture/capture.h"
#include "capture/lighting_states.h"
#include "capture/mesh_mend.h"
#include "capture/photometric.h"
#include "capture/registration_fix.h"

namespace relamp {

/// What the user says beside and against the files. Kept in the shot, so that it opens the same way.
struct CaptureFix {
    std::string up{};  ///< "x", "-y", ... or "0.1,-0.9,0.2": the direction that is up in the files; empty: as they say
    std::string meshUp{};  ///< the same of the mesh; empty: as they have, of a glTF Y where they have Z
    bool flipCameras =
        false;         ///< the matrices have OpenCV's axes (Y down, looks along +Z) though they should have OpenGL's
    double scale = 1;  ///< metres one unit of the files is long; more than 0
    double meshScale = 1;  ///< units of the cameras one unit of the mesh is long; more than 0
    /// "x", "y", "z": the cameras' files are left-handed, and this axis is reversed in the world and in each camera, or
    /// in the world alone where the matrices mirror; and the mesh's axis that is reversed. Empty: none.
    std::string mirror{}, meshMirror{};
    /// A COLMAP model's folder, its images' folder, the mesh: in the capture folder, in the current one, or absolute;
    /// empty: found by their usual names.
    std::string colmap{}, images{}, mesh{};
    int smoothNormals = -1;     ///< rounds of smoothing of the mesh's normals; below 0: as the photographs say, where a
                                ///< solve asks them (otherwise none)
    bool fromBrackets = false;  ///< merge `exposures` even where an HDR image is named
    std::vector<ProxyLight> proxies{};  ///< emitters that the mesh does not hold
    RegistrationFix registration{};     ///< of cameras and mesh; found by a solve
    MeshMend mend{};  ///< of the mesh, where emitters are not what photographs show of them; by a solve
    std::vector<StatePattern> states{};            ///< lighting states of the photographs, against what the files name
    std::vector<StateEnvironment> environments{};  ///< of lighting states, against what the files say
    PhotometricFix photometric{};                  ///< what the photographs' exposures differ by; found by a solve
    bool operator==(const CaptureFix&) const = default;
};

/// Unit vector of "x", "y", "z" with an optional sign, or of three numbers with commas between; throws Error for
/// anything else.
Vec3 axisFromName(const std::string& name);
/// The name of a direction that axisFromName takes: an axis within a thousandth, else three numbers.
std::string nameFromAxis(const Vec3& axis);
/// The rotation that takes the unit vector `up` to +Z: by a multiple of 90 degrees and exact for an axis, else the
/// shortest.
Mat3 rotationToZUp(const Vec3& up);
/// 0 to 2 of "x", "y", "z"; throws Error for anything else.
int mirrorAxis(const std::string& name);
/// Reverses an axis of the mesh, of its report's origin and of its faces' texture coordinates; faces keep their outer
/// sides.
void mirrorMesh(int axis, Mesh& mesh, MeshReport& report, std::vector<TexturedFace>& texcoords);
/// Turns and scales mesh and cameras so that the file's `up` (the mesh's own, see CaptureFix::meshUp) becomes +Z and
/// lengths are metres, and flips the cameras' axes when asked. Fills capture.up, worldFromFile (the turn alone) and
/// origin, from meshReport.origin: the mesh counts from there already, cameras and points do afterwards.
void orientCapture(Capture& capture, const Vec3& up, const CaptureFix& fix);

/// Unit direction that is up in a world where nothing says so: the axis the cameras' horizons turn about, or, where all
/// look one way, the mean of their own up directions. None without cameras.
std::optional<DVec3> guessUp(const std::vector<Camera>& cameras);

}  // namespace relamp
