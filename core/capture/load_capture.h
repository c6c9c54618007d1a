// The door of room 1: a capture folder becomes a Capture.
#pragma once
#include "base/progress.h"
#include "capture/capture.h"
#include "capture/orientation.h"

namespace relamp {

struct LoadOptions {
    bool images = true;                  ///< false: cameras and mesh only
    size_t maxPixels = size_t(1) << 28;  ///< pixels of one image
    CaptureFix fix{};                    ///< what the user says beside and against the files
};

/// Reads FOLDER/transforms.json, or a COLMAP model where there is none or `fix` names one (format:
/// core/capture/FORMAT.md), the mesh and the photographs in parallel. Frames with `exposures` and no HDR image are
/// merged, all with one response curve. Masks by convention (alpha, masks/<image file name>.png, <stem>_mask.png; black
/// is ignored). Throws Error naming file and field ("transforms.json: frame 12: fl_x is 0, expected more than 0").
Capture loadCapture(const std::filesystem::path& folder, const LoadOptions& options, Progress& progress);

/// One camera from an object with the keys of transforms.json (globals and one `transform_matrix`), as
/// `render --camera FILE` takes it. Throws Error naming the field.
Camera readCameraFile(const std::filesystem::path& file);

}  // namespace relamp
