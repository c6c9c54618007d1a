// Where photographs show something that the mesh has not. Inner part of missing parts, not a door.
#pragma once
#include <optional>

#include "base/progress.h"
#include "capture/capture.h"
#include "radiance/samples.h"
#include "scene/scene.h"

namespace relamp {

/// A view in cells of `step` x `step` pixels.
struct UnexplainedView {
    static constexpr float mostGain = 3;
    int width = 0, height = 0;  ///< cells
    int step = 1;
    /// Per cell: log likelihood that it shows something that the mesh lacks, over that of the surface or background
    /// there as other views show it. 0 where nothing is known.
    std::vector<float> gain;
    std::vector<Rgb> shown;      ///< per cell: log radiance
    std::vector<uint8_t> known;  ///< per cell: whether `gain` rests on anything
    std::vector<float> depth;    ///< per cell: metres along the ray; infinite where the background is seen

    /// The cell of a pixel position; none outside the view.
    std::optional<size_t> cellAt(const Vec2& pixel) const {
        const Vec2 at = pixel / float(step);
        if (!(at.x >= 0 && at.y >= 0 && at.x < float(width) && at.y < float(height))) return {};
        return size_t(at.y) * size_t(width) + size_t(at.x);
    }
};

/// One per view of the capture. Unusable pixels, lights and what lies beside them say nothing (`isLight`: per vertex).
/// Where a place is seen by fewer than two others of its lighting state, nothing is known. O(pixels x views), 8 others
/// and 5e6 cells at most. Throws Cancelled.
std::vector<UnexplainedView> unexplainedPixels(const Scene& scene, const Capture& capture,
                                               const RadianceSamples& samples, const std::vector<uint8_t>& isLight,
                                               Progress& progress);

}  // namespace relamp
