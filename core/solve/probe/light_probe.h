// A light probe: an image of the light as it was on the set (a latitude-longitude HDRI, an unwrapped mirror ball). How
// it is turned, its exposure and how far it can be trusted are found from the background that photographs show.
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "image/image.h"
#include "radiance/samples.h"
#include "solve/priors/anchors.h"
#include "solve/probe/probe_fit.h"

namespace relamp {

/// What the artist brings.
struct LightProbe {
    std::string name;      ///< of its file, for messages
    Image latLong;         ///< 2:1, the world's up at the top; `usable` 0: the probe does not hold that direction
    bool aligned = false;  ///< it lies along the world's axes: no yaw is sought
};

/// A probe as a measurement of the environment.
struct FittedProbe {
    ProbeFit fit;
    DirectionGrid grid{side};   ///< along the scene's axes
    std::vector<Rgb> radiance;  ///< per cell, turned and times the gain: in the photographs' unit
    std::vector<uint8_t> held;  ///< per cell: 0 where the probe holds nothing

    static constexpr int side = 256;
    /// Whether its rows take part.
    bool used() const { return fit.used; }
};
using FittedProbes = std::vector<std::shared_ptr<const FittedProbe>>;

/// Throws Error that names the file: not 2:1, all black, values that are not finite where a tenth of the image and
/// more. Single texels that are not finite count as not held.
LightProbe readLightProbe(const std::filesystem::path& file);

/// Directions at which the image clips count as not held, for it says too little there: eight texels or more, a
/// quarter of the image at most, with the largest value of a channel, which is twice its median or more. How many.
size_t leaveOutClipped(Image& image);

/// The yaw under which background and probe are most alike in log radiance, up to one factor a channel (robust, 0.05
/// degrees fine; its deviation by leaving quarters of the sphere out), that factor, and as noise the deviation that is
/// left between patches of 7 degrees. `fit.by` is empty where photographs show too little background in directions that
/// the probe holds. Cost: 0.1 s.
ProbeFit fitToBackground(const LightProbe& probe, const RadianceSamples& samples);

/// The probe by that fit, on the scene's directions.
FittedProbe fittedProbe(const LightProbe& probe, const ProbeFit& fit, const Mat3& axes);

/// Its means over the leaves.
ProbeAnchor probeAnchor(const FittedProbe& probe, const LightLeaves& leaves, size_t environment = 0);

/// The brightness of cells of `grid` inside their leaf, as probes that agree with the photographs hold it, where
/// background does not cover the leaf. `anchors`: of the leaves, those of the probes in their order.
void shapeByProbes(const FittedProbes& probes, const LightAnchors& anchors, const DirectionGrid& grid,
                   const std::vector<uint32_t>& leafOf, std::vector<float>& shape);

/// What the probes hold of a cell of their grid over what they hold of its leaf; 1 where none of them can tell.
Rgb detailOf(const FittedProbes& probes, const LightAnchors& anchors, size_t cell, uint32_t leaf);

/// Says what was found, and whether the probe is used: not above a noise of `ProbeFit::mostNoise`.
void judge(ProbeFit& fit);

}  // namespace relamp
