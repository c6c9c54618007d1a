// Places on the projector finer than its pixels: where pattern and inverse cross, fitted over a few pixels.
#pragma once
#include <array>
#include <vector>

#include "base/progress.h"
#include "scan/gray_code.h"

namespace relamp {

/// Finest bits whose crossings are kept.
constexpr int crossingBits = 4;

/// The codes of one axis of a camera, row-major.
struct CodeMap {
    int width = 0, height = 0;
    std::vector<CodeInterval> codes;
    /// (pattern - inverse) / (white - black) in units of 1/127, of the finest bits, the finest first; 0: not known.
    std::vector<std::array<int8_t, crossingBits>> contrast;
};

/// Median step of the code from a pixel to the next along a row or a column, whichever is larger; 0 without codes.
float slopeOf(const CodeMap& map);

/// A place for every pixel with a code, NaN for others. Between two pixels whose codes differ by one the pattern of one
/// bit crosses its inverse: there the place is a whole number. These crossings and the codes' middles, each by how
/// exact it is, fit a plane over (2 r + 1)^2 pixels, r the pixels a code covers plus one, 2 to 6. A pixel with few
/// neighbours of similar codes, or far from its own code, is left out. Cost: pixels x (2 r + 1)^2.
std::vector<float> fitPlaces(const CodeMap& map, float slope, Progress& progress);

}  // namespace relamp
