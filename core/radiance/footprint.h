// How a vertex looks in one view: at its place, and averaged over its footprint.
#pragma once
#include <array>
#include <optional>
#include <span>
#include <tuple>
#include <utility>

#include "capture/capture.h"
#include "radiance/gather.h"
#include "radiance/samples.h"
#include "scene/scene.h"

namespace relamp {

/// Of each scale of a look.
using ScaleWeights = std::array<float, 3>;

/// One vertex in one view at several scales: 0 is bilinear at its place, the last the mean over its footprint.
struct VertexLook {
    static constexpr size_t scales = std::tuple_size_v<ScaleWeights>;
    RadianceSample sample;                 ///< bilinear
    size_t known = 1;                      ///< scales that the photograph can tell
    std::array<Rgb, scales> radiance{};    ///< per scale
    std::array<float, scales> variance{};  ///< of each mean over that of a pixel
    /// Of the difference between two scales over that of a pixel: [fine][coarse].
    std::array<std::array<float, scales>, scales> difference{};

    /// The mean over scales, and its variance over that of a pixel, at most. Scales that are not known count as the
    /// coarsest that is.
    std::pair<Rgb, float> at(const ScaleWeights& weights) const;
};

/// Looks a vertex up. `faceNormals`: of all triangles. `radius`: of its footprint on the surface, metres. None where
/// the view does not see it. Footprints are elliptical Gaussians in the photograph [Heckbert89] over pixels of the
/// vertex's own surface, at most 13 x 13.
std::optional<VertexLook> lookUpVertex(const View& view, const ViewGeometry& geometry, const Scene& scene,
                                       std::span<const Vec3> faceNormals, uint32_t vertex, float radius,
                                       const GatherOptions& options);

/// Weights of the scales, together 1: of the coarsest at which all looks of a vertex agree with all finer ones within
/// noise [Lepski91], because an average over an edge of a shadow or a print is none of the vertex. Continuous in the
/// looks. `pixelNoise`: relative standard deviation of a pixel.
ScaleWeights scaleWeights(std::span<const VertexLook> looks, float pixelNoise, float noiseFloor);

}  // namespace relamp
