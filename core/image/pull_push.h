// Holes of an image filled smoothly from what lies around them (Gortler et al. 1996, "The Lumigraph", section 5.3).
#pragma once
#include "image/image.h"

namespace relamp {

/// `weight`: per pixel, in [0, 1], how far it is known; 1 stays as it is. What is 0 comes from around it; a
/// small weight w holds where about 1/w pixels together say the same. Columns wrap around. Sides: powers of two times a
/// common factor serve best, others lose their last row or column when halved. Memory: 21 B a pixel. Cost: 30 ns a
/// pixel.
void pullPush(Image& image, std::vector<float> weight);

}  // namespace relamp
