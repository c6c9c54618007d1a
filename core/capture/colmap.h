// COLMAP's sparse models: cameras, poses and points, binary or text. Read with suspicion: every count is held against
// the size of its file before memory is asked for.
#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/progress.h"
#include "capture/camera.h"

namespace relamp {

/// One registered photograph; the camera is complete.
struct ColmapView {
    uint32_t id = 0;          ///< COLMAP's image id; any order, with gaps
    std::string name;         ///< as COLMAP stores it, relative to the image folder
    Camera camera;            ///< in OpenGL's axes, pose inverted; world of the model
    size_t observations = 0;  ///< points seen in it
    double errorPixels = 0;   ///< mean distance between observation and projection
};

struct ColmapModel {
    std::filesystem::path folder;
    std::vector<ColmapView> views;  ///< by name, because ids hang on the run
    std::vector<DVec3> points;      ///< world of the model, its own unit
    size_t cameras = 0, observations = 0;
    /// Mean over the points of the mean distance between an observation and the projected point, pixels: computed
    /// here, and as the model itself states it (what COLMAP's model_analyzer prints). 0 without points.
    double errorPixels = 0, statedErrorPixels = 0;
    size_t behind = 0;  ///< observations whose point does not project: behind the camera, or outside the lens's field
};

struct ColmapLimits {
    size_t maxViews = 100'000, maxPoints = 50'000'000;
    size_t maxTextBytes = size_t(2) << 30;
};

/// The folder of a model at or under `folder`: itself, sparse/0, sparse, colmap/sparse/0, 0; none when there is none.
/// Where sparse holds several models the one with most images counts.
std::optional<std::filesystem::path> findColmapModel(const std::filesystem::path& folder);

/// Reads cameras, images and points3D, each .bin (preferred) or .txt; points3D may be missing. Lens models 0 to 10.
/// Throws Error naming file, entry and field: "images.bin: image 7: qw qx qy qz are 0 0 0 0, expected a rotation".
ColmapModel readColmapModel(const std::filesystem::path& folder, const ColmapLimits& limits, Progress& progress);

}  // namespace relamp
