// Brackets: several exposures of one view become radiance ([DM97]). One response curve and one scale for all views of a
// capture, because merging each set on its own gives each a scale of its own.
#pragma once
#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "base/progress.h"
#include "capture/register_bracket.h"
#include "image/image.h"

namespace relamp {

/// The camera's response: which exposure (radiance x time) gives a code. Codes run from 0 to 255 with fractions
/// between.
struct ResponseCurve {
    /// ln exposure per channel and code, never falling; 0 at code 255, so that every channel is full at exposure 1.
    std::array<std::array<double, 256>, 3> logExposure{};
    /// Standard deviation of a code in smooth parts of the photographs, per code; all channels together.
    std::array<double, 256> noise{};
    bool linear = false;  ///< codes are proportional to exposure (camera raw): used exactly, the tables follow
    size_t samples = 0;   ///< pixels the curve rests on
    double residual = 0;  ///< root mean square of what is left unexplained, ln exposure, weighted

    double exposure(int channel, double code) const;
    /// Inverse of exposure(); within [0, 255].
    double code(int channel, double exposure) const;
};

/// The curve of a camera whose codes are proportional to exposure.
ResponseCurve linearResponse();

/// One exposure of a set.
struct BracketPhoto {
    std::filesystem::path file;
    double exposure = 0;  ///< seconds, times the gain of aperture and sensitivity against the first photograph of all
    bool reference = false;  ///< the one that the camera's pose belongs to; where none is, the one most pixels of which
                             ///< are well exposed
};
using Bracket = std::vector<BracketPhoto>;

/// One pixel through the exposures of its set, in one place of the image.
struct ResponseSample {
    struct Look {
        double logExposure = 0;         ///< ln of BracketPhoto::exposure
        std::array<float, 3> code{};    ///< mean over 3 x 3 pixels, 0..255
        std::array<float, 3> spread{};  ///< standard deviation among them
    };
    std::vector<Look> looks;
};

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

/// Least squares of [DM97] eq. 3 with the radiances eliminated: 256 unknowns a channel, any number of pixels.
/// Differences from the paper: smoothness is over ln code, so that a power law costs nothing; weights come from the
/// measured noise of the codes instead of a hat; robust (Cauchy), so that what moved does not count. Throws Error when
/// fewer than two exposures differ or nothing is well exposed.
ResponseCurve fitResponse(const std::vector<ResponseSample>& samples, double smoothness = 1);

/// Smooth, well exposed places of the photographs of one set; `count` at most. Same sizes expected.
std::vector<ResponseSample> sampleBracket(const std::vector<CodeImage>& images, const std::vector<double>& exposures,
                                          size_t count);

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
