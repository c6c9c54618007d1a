// Cameras that move: turntables, splines through views, and files with many cameras.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "capture/capture.h"

namespace relamp {

/// Whether the text of a --camera option begins with turntable: or path:.
bool isCameraPath(const std::string& text);

/// turntable:N      N cameras on a full circle, counter-clockwise seen from above: view 0's camera turned about the
/// vertical through the
///                  point the views look at (the least-squares meeting point of their axes; the middle of the mesh when
///                  they are parallel)
/// path:0,3,5:N     N cameras on a Catmull-Rom spline through those views, from the first to the last; lenses are
/// interpolated too At most a million frames. Throws BadOption naming what is wrong.
std::vector<Camera> cameraPath(const Capture& capture, const std::string& text);

struct CameraFile {
    std::vector<Camera> cameras;
    bool sequence = false;  ///< the file has `frames`, however few
};

/// A file with the keys of transforms.json: globals and one `transform_matrix`, or `frames` with many (their images
/// are not needed). The file has the axes and the unit of the capture's. Throws Error naming file and field.
CameraFile readCameraPath(const Capture& capture, const std::filesystem::path& file);

}  // namespace relamp
