// Brackets: several exposures of one view become radiance ([DM97]). One response curve and one scale for all views of a
// capture, because merging each set on its own gives each a scale of its own.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "base/progress.h"
#include "capture/register_bracket.h"
#include "capture/response_curve.h"
#include "image/image.h"

namespace relamp {

/// One exposure of a set.
struct BracketPhoto {
    std::filesystem::path file;
    double exposure = 0;  ///< seconds, times the gain of aperture and sensitivity against the first photograph of all
    bool reference = false;  ///< the one that the camera's pose belongs to; where none is, the one most pixels of which
                             ///< are well exposed
};
using Bracket = std::vector<BracketPhoto>;

struct BracketOptions {
    size_t maxPixels = size_t(1) << 28;
    size_t samples = 24000;  ///< pixels for the response curve, over all sets
    double smoothness =
        1;  ///< prior on the curvature of ln exposure over ln code; larger is smoother; the data may ask for a tenth
    bool rejectGhosts = true;  ///< leave exposures out that disagree with the best one
    bool align = true;         ///< shift hand-held exposures onto the reference
};

/// Radiance of one set. Pixels are in units of exposure 1 a second: full scale at one second is radiance 1.
struct MergedBracket {
    Image image;           ///< `usable` is 0 where something moved between the exposures
    float saturation = 0;  ///< a channel at or above it was clipped even in the shortest exposure: a lower bound only
    std::vector<uint8_t> ghost;                      ///< 1 where an exposure disagreed and was left out
    std::vector<uint8_t> clipped;                    ///< 1 where a channel was clipped even in the shortest exposure
    size_t ghosts = 0, clippedPixels = 0, dark = 0;  ///< pixels; dark: black even in the longest exposure
    std::vector<PixelShift> shifts;  ///< of the exposures, as they were found; empty where none was moved
    float misfit = 0;                ///< standard deviation of what is left of the exposures' shifts, pixels, an axis
};

/// Reads all sets and fits one curve; where every file is linear (camera raw), linearResponse(). Throws Error naming
/// the file.
ResponseCurve responseOf(const std::vector<Bracket>& sets, const BracketOptions& options, Progress& progress);

/// Weighted mean of code^-1(z) / exposure over the exposures that saw the pixel well; weights are inverse variances at
/// the code that the mean predicts, because weights from the measured code itself would lean to the dark. Where the
/// image has edges, what is left of the exposures' shifts adds to the variance of each (its size is measured on the
/// set itself), so that they count alike there. `shifts`, where not empty: what the images were shifted by already;
/// beyond their rims they count nothing. Same bits on any number of threads.
MergedBracket mergeCodes(const std::vector<CodeImage>& images, const std::vector<double>& exposures,
                         const ResponseCurve& response, const BracketOptions& options, Progress& progress,
                         const std::vector<PixelShift>& shifts = {});

/// The same from files, shifted onto the reference. Throws Error naming the file: unreadable, another size than the
/// first.
MergedBracket mergeBracket(const Bracket& set, const ResponseCurve& response, const BracketOptions& options,
                           Progress& progress);

/// Exposures of files, from `times` (seconds) where given, else from EXIF; aperture and sensitivity from EXIF in both
/// cases unless `times` are given. `reference` becomes the first photograph's settings and is used for all later sets.
/// Throws Error naming the file without an exposure time.
struct ExposureReference {
    double aperture = 0, iso = 0;
    bool known = false;
};
BracketPhoto bracketPhoto(const std::filesystem::path& file, ExposureTags tags, ExposureReference& reference);

}  // namespace relamp
