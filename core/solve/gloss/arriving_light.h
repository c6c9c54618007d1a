// Light that arrives at observations of glossy surfaces, drawn once for lobes of any width.
#pragma once
#include "base/progress.h"
#include "brdf/basis.h"
#include "solve/gloss/gloss.h"

namespace relamp {

/// Directions are drawn once an observation, from GGX of four widths, the cosine and the emitters, combined by multiple
/// importance sampling [Veach97], and serve all lobes. Cost: observations x 4 rows.lobeSamples / 3 rays, and those that
/// observations of a vertex share (transport/shared_directions.h). Memory: 24 B for each direction that light comes
/// from. Same bits on any number of threads.
class ArrivingLight {
public:
    ArrivingLight(const Scene& scene, const std::vector<EmitterSurface>& emitters,
                  const std::vector<int>& emitterOfTriangle, const Lighting& lighting,
                  const std::vector<GlossyObservation>& observations, const LobeRowOptions& rows, Progress& progress);

    /// Radiance that a lobe of weight 1 sends at each observation. Cost: an evaluation a direction; by all threads.
    std::vector<Rgb> through(const Lobe& lobe) const;

    struct Direction {
        Vec3 local;    ///< z along the normal
        Rgb radiance;  ///< times cosine over density
    };

private:
    std::vector<std::vector<Direction>> directions_;  ///< per observation
    std::vector<Vec3> eye_;                           ///< local
};

/// ArrivingLight through many lobes, and forgotten at once: result[lobe][observation]. Lobe 0 (Lambert) is skipped:
/// zeros.
std::vector<std::vector<Rgb>> lobeResponses(const Scene& scene, const std::vector<EmitterSurface>& emitters,
                                            const std::vector<int>& emitterOfTriangle, const Lighting& lighting,
                                            const std::vector<Lobe>& lobes,
                                            const std::vector<GlossyObservation>& observations,
                                            const LobeRowOptions& rows, Progress& progress);

}  // namespace relamp
