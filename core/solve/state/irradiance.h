// What the present light makes of the observations. It is computed where it is needed and never kept: light moves on.
#pragma once
#include "solve/gloss/matte.h"
#include "solve/ratio/pairs.h"
#include "transport/incident.h"

namespace relamp {

/// Per observation, as a white matte surface shows it (radiance).
struct Irradiance {
    std::vector<Rgb> value;
    /// Standard deviation: at shadow edges an observation mixes irradiance with its neighbours'.
    std::vector<Rgb> sigma;

    /// Of the observations of one lighting state.
    Irradiance inState(const MatteObservations& matte, size_t state) const;
};

/// Of `rows` under `lighting`, with light from other surfaces if `bounce` is not empty. Cost O(rows columns).
Irradiance irradianceOf(const InfluenceMatrix& rows, const Lighting& lighting, const std::vector<Rgb>& bounce,
                        const std::vector<AlbedoPair>& pairs);

/// Root mean square relative difference between points of probably equal albedo (robustStep): the same measure in every
/// stage and mode, because albedo cancels and cannot hide what the light gets wrong.
double pairMismatch(const MatteObservations& matte, const std::vector<AlbedoPair>& pairs, const Irradiance& irradiance);

/// Fraction of the light on the observations that comes from other surfaces; 0 for an empty `bounce`.
float bouncedFractionOf(const std::vector<Rgb>& bounce, const Irradiance& irradiance);

}  // namespace relamp
