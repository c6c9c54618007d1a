// The plate's colours against the capture's: one gain a channel for the shot, or one that follows the plate where it
// breathes.
#pragma once
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "plate/plate_sequence.h"
#include "relight/frame.h"

namespace relamp {

enum class PlateMatching {
    automatic,  ///< one for the shot; one a frame where key frames differ by more than half a percent and their noise
    shot,
    frames,
    off
};

/// Throws BadOption when `name` is none of auto, shot, frames, off.
PlateMatching plateMatching(const std::string& name);

/// Plate radiance / capture radiance of the surfaces that both show, by frame.
struct PlateGains {
    std::map<int, Rgb> keys;            ///< of key frames, smoothed over time; one for a shot; none: 1
    std::map<int, Rgb> between;         ///< of frames that were matched one by one (matchBetween)
    Rgb noise{0};                       ///< standard error of one key frame's, relative
    float spread = 0;                   ///< of the key frames, relative, robust
    bool breathes = false;              ///< the gain follows the frame
    std::vector<std::string> faults{};  ///< key frames that could not be read, one sentence each
    /// A frame's own, else between key frames in proportion in stops, constant beyond.
    Rgb at(int frame) const;
};

/// One key frame as it is asked for.
struct PlateKey {
    int frame = 1;
    Camera camera;
    std::function<Image(float& saturation)> read;
    std::function<std::vector<float>()> matte;  ///< null: nothing is held out
};

struct PlateMatchOptions {
    PlateMatching kind = PlateMatching::automatic;
    size_t keyFrames = 24;  ///< at most, spread over the plate
    size_t pixels = 1500;   ///< rendered in each
    uint64_t seed = 1;
};

/// Two kinds of evidence, channel by channel: the median over surfaces of plate / model in each key frame, good to 2 %,
/// and the median change of the same surface points from one key frame to the next, which no error of the model
/// touches. The gains are the least-squares answer to both. Emitters, the background, what is held out, clipped or
/// darker than a hundredth of white do not count; a key frame with fewer than 50 pixels is left out. It depends on the
/// whole plate and no frame range, so parts of a sequence agree. A key frame that cannot be read is left out and named.
/// Cost: 0.1 ms a pixel and core. Throws OutOfResources, Cancelled.
PlateGains matchPlate(const RelitScene& captured, const std::vector<PlateKey>& keys, const PlateMatchOptions& options,
                      Progress& progress);

/// Adds the gains of frames between two key frames (before the first, after the last) whose own are in `gains`: those
/// stay, and the median changes from one frame to the next share the way between them. `frames`: in order, the key
/// frames at the ends among them. So a part of a sequence reads those it lies between, and parts agree. A frame that
/// cannot be read is left out. Cost: a frame read and `pixels` rays each. Throws OutOfResources, Cancelled.
void matchBetween(const RelitScene& captured, const std::vector<PlateKey>& frames, const PlateMatchOptions& options,
                  PlateGains& gains, Progress& progress);

/// Which of `count` frames are key frames.
std::vector<size_t> keyFramesOf(size_t count, size_t most);

}  // namespace relamp
