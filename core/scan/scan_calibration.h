// cameras.json of a structured-light scan: calibrated cameras, and the projector where it is calibrated too.
#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "capture/camera.h"

namespace relamp {

/// A camera that photographed the patterns.
struct ScanCamera {
    std::string name;              ///< of the file, distinct, fit for a file's name
    std::filesystem::path folder;  ///< of its photographs
    Camera camera;                 ///< metres; axes of the file's world
};

struct ScanCalibration {
    std::vector<ScanCamera> cameras;  ///< at least one
    std::optional<Camera> projector;  ///< where the file gives it; a pixel is the place of a code
};

/// Reads `views` (and `projector`, with the same keys): `name`, `image` (its folder holds the photographs), `width`,
/// `height`, `K`, `R`, `t` of OpenCV (x_camera = R X + t, whole numbers at the centres of pixels), `distortion` (k1 k2
/// p1 p2 k3 k4 k5 k6, of which the last may be left out; also as `distortion_k1k2p1p2k3`), and `units` (metre,
/// centimetre or millimetre). Throws Error naming file and field.
ScanCalibration readScanCalibration(const std::filesystem::path& file);

}  // namespace relamp
