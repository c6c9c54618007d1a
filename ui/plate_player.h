// Reads frames of a plate ahead of what is shown, one at a time, on a thread of its own; keeps those that were read.
#pragma once
#include <functional>
#include <map>
#include <memory>

#include "base/job.h"
#include "editor_state.h"

namespace relamp::ui {

/// Opens the plate of `look`: files, cameras, and, with an `estimate`, its colours against the capture's (few pixels of
/// four frames). What cannot be used at all comes back as `trouble`. Throws Cancelled. Cost: a listing of the folder,
/// four frames read; with an estimate about a second.
std::shared_ptr<const OpenPlate> openPlateOf(const PlateLook& look, const std::shared_ptr<const Capture>& capture,
                                             const std::shared_ptr<const Scene>& scene,
                                             const std::shared_ptr<const Estimate>& estimate, Progress& progress);

/// An image of the plate as it is shown; `gain`: plate / capture.
PlateImage shownPlate(Image image, const PlateFrame& frame, const Rgb& gain);
/// The image of one frame. Throws Error naming the file, Cancelled.
PlateImage readPlateImage(const OpenPlate& plate, const PlateFrame& frame, Progress& progress);

/// Used on one thread.
class PlatePlayer {
public:
    /// `wake` is called on the reading thread when a frame has been read.
    explicit PlatePlayer(std::function<void()> wake) : wake_(std::move(wake)) {}

    /// Takes what was read, and reads what is missing of `frame` first, then, when `ahead`, of the frames after it.
    /// Null: nothing is shown. At most `mostBytes` are kept; where playing goes on beyond them, what is kept stays and
    /// the next few frames are read in passing, so that a loop reads only what finds no room. Returns the trouble with
    /// a frame that could not be read, once; else empty.
    std::string show(const std::shared_ptr<const OpenPlate>& plate, int frame, bool ahead, size_t mostBytes);
    /// Of the frame asked for last, or the last one that was shown until it has been read.
    const std::shared_ptr<const PlateImage>& image() const { return shown_; }
    /// The image of the frame asked for last is there, or cannot be had.
    bool ready() const { return ready_; }
    bool working() const { return reading_ != nullptr; }
    size_t read() const { return read_; }  ///< frames so far

private:
    static constexpr int mostAhead = 8;
    std::function<void()> wake_;
    std::shared_ptr<const OpenPlate> plate_;
    std::map<int, std::shared_ptr<const PlateImage>> kept_, passing_;  ///< passing: for a moment, while playing
    size_t bytes_ = 0, read_ = 0;
    std::shared_ptr<const PlateImage> shown_;
    bool ready_ = true;
    int readingFrame_ = 0;
    std::string trouble_;
    std::unique_ptr<Job<PlateImage>> reading_;

    void take(bool ahead, size_t mostBytes);
    void keep(std::shared_ptr<const PlateImage> image, bool ahead, size_t mostBytes);
    /// Null: it is to be read.
    std::shared_ptr<const PlateImage> held(int frame) const;
};

}  // namespace relamp::ui
