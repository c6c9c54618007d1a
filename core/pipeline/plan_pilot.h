// A coarse light fit on a few thousand pairs of points: enough to tell whether a whole kind of light is there at all.
// Not a door.
#pragma once
#include <cstddef>
#include <string>

#include "clusters/emitter_clusters.h"
#include "radiance/samples.h"
#include "scene/scene.h"
#include "solve/ratio/pairs.h"
#include "solve/solve.h"

namespace relamp {

/// Of bounceWorse: below it bounced light takes part from the start.
constexpr double likelyBounce = -2;

/// Emitters and candidates, as the solve will take them: none without near-field light.
EmitterClusters allEmitters(const Scene& scene, const EmitterClusters& clusters, bool nearField);

/// What each row says of the light.
std::vector<Rgb> litBy(const InfluenceMatrix& rows, const Lighting& lighting);

struct PilotFindings {
    bool ran = false;              ///< false: too few matte points
    size_t pairs = 0, points = 0;  ///< looked at
    double distantFraction = 1;    ///< of the light on the points that comes from afar
    double background = -1;        ///< backgroundOverSurfaces
    double enclosure = 1;          ///< fraction of what the points see that other surfaces fill
    double bouncedFraction = 0;    ///< light from other surfaces over all light, if it were in the photographs
    double bounceWorse =
        0;  ///< mean rise of the pairs' misfit when bounced light is taken for real, in standard errors of that mean
    int iterations = 0;  ///< of the coarse fit
    Lighting lighting;   ///< the light found, coarse but for strong directions; with bounced light where that is
                         ///< explained better
    // What components of the work took, for the cost model.
    double visibilitySecondsPerRay = 0, edgeSecondsPerPoint = 0, nearSecondsPerPoint = 0, rowSecondsPerCell = 0,
           bounceSecondsPerRay = 0, iterationSeconds = 0;
    size_t rows = 0, columns = 0;
};

/// `pairs` of all matte observations; every random choice goes by the points' places, not by their order. Cost: about
/// 0.4 s on a mesh of 30000 vertices. Throws Cancelled.
PilotFindings runPilot(const Scene& scene, const RadianceSamples& samples, const EmitterClusters& emitters,
                       const MatteObservations& matte, const std::vector<AlbedoPair>& pairs,
                       const SolveOptions& options, Progress& progress);

/// Misfit of each of the pilot's pairs, bent, under the coarse light fitted to them: what fits with other normals can
/// be held against, pair by pair. `probes`: light probes that take part. `bounce`: of pilotBounce, for the same pairs
/// and options.
std::vector<double> pilotMisfits(const Scene& scene, const RadianceSamples& samples, const EmitterClusters& emitters,
                                 const MatteObservations& matte, const std::vector<AlbedoPair>& pairs,
                                 const SolveOptions& options, Progress& progress, const FittedProbes& probes = {},
                                 const std::vector<Rgb>& bounce = {});

/// Light from other surfaces on the pilot's points, as photographs show those; empty: it explains nothing.
std::vector<Rgb> pilotBounce(const Scene& scene, const RadianceSamples& samples, const EmitterClusters& emitters,
                             const MatteObservations& matte, const std::vector<AlbedoPair>& pairs,
                             const SolveOptions& options, Progress& progress);

/// How much better one fit explains the pilot's pairs than another.
struct MisfitFall {
    double part = 0;    ///< of the whole misfit; below 0: it rises
    double errors = 0;  ///< standard errors of it, pair by pair
    size_t pairs = 0;
    /// Whether it is both at least so large and so sure.
    bool exceeds(double leastPart, double leastErrors) const { return part > leastPart && errors > leastErrors; }
    /// From the other fit to this one.
    MisfitFall reversed() const { return {-part, -errors, pairs}; }
    /// "misfit of 4000 pairs -7.03 %, 8.7 standard errors".
    std::string words() const;
};
MisfitFall misfitFall(const std::vector<double>& before, const std::vector<double>& after);

}  // namespace relamp
