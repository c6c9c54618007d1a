// The camera's response, fitted to several exposures of the same pixels ([DM97]).
#pragma once
#include <array>
#include <vector>

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

/// One pixel through the exposures of its set, in one place of the image.
struct ResponseSample {
    struct Observation {
        double logExposure = 0;         ///< ln of BracketPhoto::exposure
        std::array<float, 3> code{};    ///< mean over 3 x 3 pixels, 0..255
        std::array<float, 3> spread{};  ///< standard deviation among them
    };
    std::vector<Observation> observations;
};

/// Least squares of [DM97] eq. 3 with the radiances eliminated: 256 unknowns a channel, any number of pixels.
/// Differences from the paper: smoothness is over ln code, so that a power law costs nothing; weights come from the
/// measured noise of the codes instead of a hat; robust (Cauchy), so that what moved does not count. Throws Error when
/// fewer than two exposures differ or nothing is well exposed.
ResponseCurve fitResponse(const std::vector<ResponseSample>& samples, double smoothness = 1);

/// Smooth, well exposed places of the photographs of one set; `count` at most. Same sizes expected.
std::vector<ResponseSample> sampleBracket(const std::vector<CodeImage>& images, const std::vector<double>& exposures,
                                          size_t count);

}  // namespace relamp
