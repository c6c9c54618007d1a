// Exposure, white balance and fall-off of the photographs, from what they say of the same surfaces.
#pragma once
#include "base/progress.h"
#include "capture/capture.h"
#include "capture/photometric.h"
#include "radiance/samples.h"
#include "scene/scene.h"

namespace relamp {

struct PhotometricEstimate {
    PhotometricFix fix;
    float spread = 0, spreadAfter = 0;  ///< robust standard deviation of log radiance about each vertex's mean over
                                        ///< views, before and with the fix
    float gainRms = 0;                  ///< of the logarithms of the gains, all channels
    /// True when the photographs agree by a quarter better with it, and what it takes out is not small beside what is
    /// left: what metals show and what a mesh that is off leaves can be imitated by gains.
    bool needed() const {
        const float taken = std::max(gainRms, 0.5f * std::abs(std::log(fix.falloffAt(1))));
        return spreadAfter < 0.75f * spread && taken > 0.01f && taken > 0.5f * spreadAfter && spreadAfter < 0.2f;
    }
};

/// Least squares, robust (Cauchy), over log y_vi = m_v + g_i + a r^2 + b r^4 with the means m_v eliminated: surfaces'
/// colour and light cancel, what a gloss shows is an outlier. The fall-off is kept where it lowers the spread by a
/// twentieth. Gains that a chain of common surfaces does not reach stay 1. Cost: a few passes over the observations,
/// one factorisation of 3 x views + 2 unknowns. Throws Cancelled.
PhotometricEstimate estimatePhotometric(const Capture& capture, const Scene& scene, const RadianceSamples& samples,
                                        Progress& progress);

/// "exposures differ by 9 %, white balance by 3 %, the lens darkens the corners by 18 %".
std::string toText(const PhotometricEstimate& estimate);

}  // namespace relamp
