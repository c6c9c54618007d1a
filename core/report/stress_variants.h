// Captures made harder: each function takes a capture by value and gives back the variant.
#pragma once
#include "base/math.h"
#include "capture/capture.h"

namespace relamp {

/// Photographs at most `longestSide` pixels; never larger than they were.
Capture withSmallImages(Capture capture, int longestSide);
/// Every photograph times `factor`.
Capture withRadianceTimes(Capture capture, const Rgb& factor);
/// Gaussian noise of this relative standard deviation on every pixel and channel; 0.2 is 20 %.
Capture withNoise(Capture capture, float relative, uint64_t seed);
/// Every photograph brighter or darker as a whole: a factor of this relative standard deviation each.
Capture withExposures(Capture capture, float relative, uint64_t seed);
/// A fraction of the pixels replaced by 0 or a thousand times what they were.
Capture withOutliers(Capture capture, float fraction, uint64_t seed);
/// `count` views spread over the capture.
Capture withViews(Capture capture, size_t count);
/// All views clipped at this percentile (0 to 100) of their own luminance.
Capture withClipping(Capture capture, float percentile);
/// Mesh and cameras moved: p -> scale * turn * p + offset, in double and then placed as a capture is that is read from
/// such files (Capture::origin). `offset` in units of the scaled scene.
Capture movedBy(Capture capture, double scale, const glm::dmat3& turn, const DVec3& offset);
/// The length of the mesh's bounding box.
double extentOf(const Capture& capture);
/// Vertices and triangles numbered otherwise. `newIndex[v]` = where vertex v went.
Capture withVerticesShuffled(Capture capture, uint64_t seed, std::vector<uint32_t>& newIndex);
Capture withViewsReversed(Capture capture);

}  // namespace relamp
