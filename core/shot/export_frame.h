// Frames on disk: which cameras and files a render asks for, and one frame as an EXR with light groups (INTERFACE section 5).
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "base/error.h"
#include "capture/capture.h"
#include "relight/frame.h"

namespace relamp {

/// A command-line option that cannot be meant.
class BadOption : public Error {
public:
    using Error::Error;
};

struct FrameJob {
    Camera camera;
    std::filesystem::path file;
    int number = 1;
};

/// `camera`: a view's number (from 0), a camera file, or "all" (frames numbered from 1, then `output` needs #### or %04d when there
/// is more than one). `frames` selects among them ("1-3,5,7-20:2"; numbers outside are skipped with a notice). `size` "WxH" or empty.
/// Throws BadOption naming the option, Error when a camera file is bad.
std::vector<FrameJob> frameJobs(const Capture& capture, const std::string& camera, const std::string& frames, const std::string& size,
                                const std::filesystem::path& output);

/// Numbers of a range expression, at most a million; throws BadOption naming what is wrong.
std::vector<int> parseFrameRange(const std::string& text);

/// Throws BadOption when `layers` names one that does not exist.
void checkLayers(const std::string& layers);

/// Writes the frame, whole or not at all. EXR: root RGBA and the layers asked for ("", "all", or a comma list of groups, albedo,
/// normal, position, depth); PNG and JPEG: the beauty, sRGB. Returns the largest relative difference between beauty and the sum of
/// the light groups.
double writeFrame(const std::filesystem::path& file, const Frame& frame, const RelitScene& relit, const Camera& camera, const std::string& layers);

}  // namespace relamp
