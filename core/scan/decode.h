// Photographs of Gray-code patterns become the place on the projector that each pixel sees.
#pragma once
#include <functional>
#include <optional>
#include <vector>

#include "base/progress.h"
#include "scan/gray_code.h"
#include "scan/scan_photographs.h"

namespace relamp {

/// Linear luminance, row-major from the top left.
struct GreyImage {
    int width = 0, height = 0;
    std::vector<float> values;
};

/// The photographs of one camera. `read` is called from several threads; places as in ScanPhotographs.
struct PatternStack {
    ScanBits bits{};
    std::vector<uint8_t> there;  ///< for each place, whether there is a photograph
    std::function<GreyImage(size_t place)> read;
    size_t pixels = 0;  ///< of one photograph, as expected: how many are read at once depends on it
};

struct DecodeOptions {
    std::array<int, 2> projectorSize{};  ///< codes beyond it are none; 0: as the bits have
    float noises = 3;            ///< pattern and inverse differ by more than this many standard deviations of noise
    float leastContrast = 0.1f;  ///< and by this fraction of the light that comes from the projector directly
    int widestInterval = 4;      ///< codes that are less exact are left out, projector pixels
};

/// Bits of a camera that no photograph shows, by axis.
struct LostBits {
    std::vector<size_t> absent;            ///< places of the missing photographs
    std::array<std::vector<int>, 2> bits;  ///< bits, most significant first, of which pattern and inverse are missing
    std::array<int, 2> exactness{1, 1};    ///< projector pixels that most codes are exact to
};

/// What a camera sees of the projector.
struct DecodedView {
    int width = 0, height = 0;
    std::vector<glm::vec2> places;  ///< projector pixels, the first's centre at (0.5, 0.5); NaN where not known
    LostBits lost;
    size_t lit = 0;      ///< pixels that the projector lights clearly
    size_t decoded = 0;  ///< of those, with a place
    size_t coarse = 0;   ///< of those, with an interval of two or more pixels before the fit
    float noise = 0;     ///< standard deviation of one photograph's luminance, relative to the median of lit white
    float global = 0;    ///< median fraction of indirect light in white, ambient light not counted
    float slope = 0;     ///< median step of the places from pixel to pixel, projector pixels
    bool at(size_t pixel) const { return places[pixel].x == places[pixel].x; }
};

/// Thresholds by direct and global light [Nayar06] [XuAliaga07]: the fine patterns give each pixel's direct light d and
/// indirect light g. A bit is read where the intervals [0, g] and [d, d + g] tell pattern from inverse, and where both
/// differ by more than the noise, which pattern + inverse of several bits tell. A pattern or inverse alone is
/// held against that sum. Places are then fitted over a few pixels (code_fit.h). Same bits on any number of threads.
/// Memory: about 48 bytes a pixel, and 28 for each photograph that is read at once. Throws Error: white is darker than
/// black, sizes differ, nothing is lit; whatever `read` throws; Cancelled.
DecodedView decodePatterns(const PatternStack& stack, const DecodeOptions& options, Progress& progress);

}  // namespace relamp
