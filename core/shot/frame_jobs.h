// Which frames a render asks for: cameras, file names and numbers (docs/interface.md 4).
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "capture/capture.h"
#include "image/image_region.h"
#include "shot/frame_numbers.h"

namespace relamp {

struct FrameJob {
    Camera camera;
    std::filesystem::path file;
    int number = 1;        ///< in the sequence, from 1: what keyed looks go by
    int view = -1;         ///< the capture's view whose camera this is, from 0; -1: a camera of its own
    bool resized = false;  ///< not at the camera's own size
    bool still = false;    ///< one camera for all frames of a range: only a look with keys tells them apart
};

/// `camera`: a view's number (from 0), a camera file (one camera, or a transforms.json with `frames`), turntable:N,
/// path:V,V,...:N (camera_path.h), or "all" views. Sequences are numbered from 1, then `output` needs #### or %04d when
/// there is more than one frame. `frames` selects among them ("1-3,5,7-20:2"; numbers outside are skipped with a
/// notice); with one camera it is the frames of a keyed look. `size` "WxH" or empty. Throws BadOption naming the
/// option, Error when a camera file is bad.
std::vector<FrameJob> frameJobs(const Capture& capture, const std::string& camera, const std::string& frames,
                                const std::string& size, const std::filesystem::path& output);

/// The camera of that part of its image.
Camera cropped(Camera camera, const ImageBox& box);

/// Numbers of a range expression, at most a million; throws BadOption naming the option and what is wrong.
std::vector<int> parseFrameRange(const std::string& text, const std::string& option = "--frames");

}  // namespace relamp
