// The photographs of a capture, read one at a time: where not all of them are wanted at once.
#pragma once
#include "base/input_files.h"
#include "capture/brackets.h"
#include "capture/capture_source.h"
#include "capture/load_capture.h"

namespace relamp {

/// Knows where every photograph is and how exposures are merged; holds no pixels.
class PhotographReader {
public:
    /// Throws Error as loadCapture does for the files that say where photographs are. Cost: where exposures are merged,
    /// the response curve's reading.
    PhotographReader(const std::filesystem::path& folder, const LoadOptions& options, Progress& progress);
    PhotographReader(CaptureSource source, const std::filesystem::path& folder, const LoadOptions& options,
                     Progress& progress);

    size_t count() const { return source_.frames.size(); }
    /// Whether a photograph is merged from exposures, on all cores; otherwise one is read on one core.
    bool merges() const { return !sets_.empty(); }
    /// What is to be said of all of them.
    const std::vector<std::string>& notes() const { return notes_; }
    /// View `i` with its pixels, masks applied; the camera as the files have it. Bits do not depend on what else is
    /// read. Stops within 256 rows of pixels. Memory: that image; merged, its exposures. Throws Error naming frame
    /// and file, Cancelled.
    View read(size_t i, std::vector<std::string>& notes, Progress& progress) const;
    /// The same without pixels: a camera that fits the image's size.
    View readCamera(size_t i, std::vector<std::string>& notes) const;

private:
    std::filesystem::path folder_;
    LoadOptions options_;
    CaptureSource source_;
    std::vector<Bracket> sets_;
    ResponseCurve response_;
    BracketOptions bracketOptions_;
    std::vector<std::string> notes_;
};

/// Every file that a capture is read from: cameras, mesh, photographs, exposures, masks. Throws Error as loadCapture
/// does for the files that hold the cameras. Cost: reading those.
InputFiles captureFiles(const std::filesystem::path& folder, const CaptureFix& fix, Progress& progress);

}  // namespace relamp
