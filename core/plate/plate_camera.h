// The tracked camera of a plate, a pose and a lens for every frame: transforms.json, COLMAP models, Nuke's .chan and
// USD text.
#pragma once
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "base/progress.h"
#include "capture/capture.h"
#include "plate/plate_sequence.h"

namespace relamp {

struct PlateCameraOptions {
    /// A file with the intrinsic keys of transforms.json (w, h, fl_x, cx, k1, ...) in place of the track's lens; empty:
    /// the track's. It is scaled to the plate's size.
    std::filesystem::path lens{};
    std::string rotationOrder = "ZXY";  ///< of .chan files: the axis turned about first comes first
    int offset = 0;                     ///< the track's frame N is the plate's N + offset
};

struct PlateCameras {
    std::map<int, Camera> byFrame;   ///< in the capture's world, metres, at the plate's size; by the plate's numbers
    std::vector<std::string> notes;  ///< what was assumed, one sentence each
};

/// Reads the camera of the plate with these `files`, all `width` x `height`. By name: .chan; .usda (FILE#NAME for one
/// of several cameras); .json with one `transform_matrix` for all frames, or `frames`, whose numbers are those in
/// `file_path` where all have one, else in the order of the plate; a folder with a COLMAP model, numbers from the image
/// names. Poses count in the axes and unit of the capture's files, those of USD in its own up axis and metres. Throws
/// Error naming file, line or field; BadOption for a wrong rotation order.
PlateCameras readPlateCameras(const Capture& capture, const std::filesystem::path& file, const PlateFiles& files,
                              int width, int height, const PlateCameraOptions& options, Progress& progress);

// ---- the readers of single formats; poses as their files have them

/// A camera over time, as a track has it.
struct TrackedCamera {
    DMat4 worldFromCamera{1.0};  ///< OpenGL's axes
    /// Tangents of half the field of view, 0 where not given; `centre`: of the principal point from the image's middle,
    /// in widths and heights, x to the right, y down.
    double halfWidth = 0, halfHeight = 0;
    glm::dvec2 centre{0};
};
struct CameraTrack {
    std::map<int, TrackedCamera> byFrame;
    bool still = false;        ///< one camera for every frame (byFrame holds it as frame 0)
    std::string up{};          ///< "y" or "z" where the file says so; empty: the capture's
    double metresPerUnit = 0;  ///< 0: the capture's
    std::vector<std::string> notes{};
};

/// Lines "frame tx ty tz rx ry rz [vertical field of view]", degrees; # begins a comment. A rotation order of ZXY (the
/// default of Nuke's cameras) turns about Z first, then X, then Y. Limits: a million lines.
CameraTrack readChan(const std::filesystem::path& file, const std::string& rotationOrder);

/// The camera `name` of a USD text file (its name or path; empty: the one there is, else the only one that moves), with
/// the transforms of its parents. Frames are the whole time codes between its first and last sample; between samples
/// values are linear. Limits: 1 GiB, 100 000 frames, 64 levels.
CameraTrack readUsdCamera(const std::filesystem::path& file, const std::string& name);

}  // namespace relamp
