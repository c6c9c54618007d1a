// What the photographs show of the background, per cell of a grid of directions.
#pragma once
#include <vector>

#include "capture/capture.h"
#include "radiance/samples.h"

namespace relamp {

/// Sums over the pixels of one view that see neither geometry nor its edge.
struct BackgroundCells {
    std::vector<Rgb> sum;          ///< per cell
    std::vector<uint32_t> pixels;  ///< per cell
    Rgb mean(size_t cell) const { return sum[cell] / float(pixels[cell]); }
};

/// O(pixels).
BackgroundCells backgroundCells(const View& view, const ViewGeometry& geometry, const DirectionGrid& grid);

/// How far a radiance is from a range: mean of the channels' logarithms. Below `floor` all is alike.
float logDistance(const Rgb& radiance, const Rgb& low, const Rgb& high, float floor);

}  // namespace relamp
