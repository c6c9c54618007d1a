// transforms.json: cameras and file names of a capture (FORMAT.md). Parsing only: no image or mesh is opened here,
// but for the size of an image whose `w` and `h` are not given.
#pragma once
#include <filesystem>
#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <utility>
#include <vector>

#include "capture/camera.h"
#include "capture/lighting_states.h"

namespace relamp {

/// One exposure of a bracket.
struct Exposure {
    std::string filePath;
    double seconds = 0;            ///< exposure time; 0: not given, EXIF says it
    double aperture = 0, iso = 0;  ///< f-number and sensitivity; 0: not given
};

/// One frame as the file says it; the camera is complete.
struct TransformsFrame {
    std::string filePath;  ///< as written, relative to the capture folder; empty when only brackets are given
    Camera camera;
    std::vector<Exposure> exposures;
    std::string maskPath;  ///< as written; empty when the key is absent
    std::string state;     ///< lighting state; empty when the key is absent
};

struct Transforms {
    std::vector<TransformsFrame> frames;
    std::vector<StateEnvironment> environments;  ///< of lighting states, where `states` says it
    std::string meshPath;                        ///< as written; empty when the key is absent
    Vec3 up{0, 0, 1};
    bool leftHanded = false;         ///< the matrices mirror; the cameras here have their axis `mirror` reversed
    std::vector<std::string> notes;  ///< what was set right or ignored, one sentence each
};

/// Width and height of the image with this file_path.
using ImageSize = std::function<std::pair<int, int>(const std::string& filePath)>;

/// Parses the text of a transforms.json. `sizeOf` is asked where w and h are missing. Limits: nesting of 32, 100000
/// frames, 8 million values. `mirror`: the camera's axis that is reversed where matrices mirror, -1: these are an
/// error. Throws Error naming frame and field, without the file's name.
Transforms parseTransforms(const std::string& text, const ImageSize& sizeOf, int mirror = -1);

/// The same for a file of at most 64 MiB; errors begin with its name.
Transforms readTransforms(const std::filesystem::path& file, const ImageSize& sizeOf, int mirror = -1);

/// A frame of the file: what parseTransforms reads as `filePath` and `camera`.
nlohmann::json transformsFrame(const Camera& camera, const std::string& filePath);

}  // namespace relamp
