// Hand-held brackets: how far each exposure is shifted against a reference [Ward03].
#pragma once
#include <vector>

#include "image/image.h"

namespace relamp {

/// Pixel (x, y) of the reference shows what pixel (x + shift.x, y + shift.y) of the other image shows.
struct PixelShift {
    int x = 0, y = 0;
    bool operator==(const PixelShift&) const = default;
};

/// Shifts of all images against `reference` by median threshold bitmaps, which do not hang on exposure: a pyramid
/// from coarse to fine, each exposure against its neighbour in the order of exposures. Whole pixels, no rotation, up to
/// a twenty-fifth of the width; 0 where shifting does not lower the fraction of pixels that disagree by a tenth. Images
/// of one size expected. Cost: 9 x 4/3 comparisons a pixel.
std::vector<PixelShift> bracketShifts(const std::vector<CodeImage>& images, const std::vector<double>& exposures,
                                      size_t reference);

/// The image brought onto the reference; black where it shows nothing.
CodeImage shifted(const CodeImage& image, const PixelShift& shift);

}  // namespace relamp
