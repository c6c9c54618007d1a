// Pairs of vertices with probably equal albedo: what fixes the light without knowing any albedo (docs/method.md 11).
#pragma once
#include "scene/scene.h"
#include "solve/gloss/matte.h"
#include "solve/ratio/ratio_residual.h"

namespace relamp {

struct AlbedoPair {
    uint32_t a = 0, b = 0;  ///< positions in MatteObservations
    float weight = 1;
    bool edge = false;  ///< of the mesh
    bool same = false;  ///< one vertex in two lighting states: the albedo is exactly one
};

struct PairOptions {
    uint64_t seed = 1;
    float edgeWeight = 0.3f;
    float cornerWeight = 0.3f;
    float cornerCosine = 0.906f;  ///< normals more than 25 degrees apart
    float flatCosine = 0.985f;    ///< and within 10 degrees of those of their own neighbours
    int longPairs = 2;            ///< a vertex, on average twice as many
    float longWeight = 0.5f;
    float longCosine = 0.7f;  ///< normals less than 45 degrees apart
    float sameWeight = 2;     ///< of all pairs that a vertex has between lighting states, each with all others
};

/// Mesh edges, the ends of short random walks on the mesh, corner pairs (near in space, differently oriented: decisive
/// where faces are planar), and long pairs (anywhere on the same component, facing alike). Errors of the model are as
/// large over a metre as over a millimetre, while an emitter's light changes much over a metre: short pairs alone take
/// errors for a lack of contrast and make ambient light too strong (attenuation, as in any regression with errors in
/// its rows). So edges count little, and corner pairs stay out of the round that reconstruction makes of a crease,
/// where normals are none of the photographed surface's. Where long pairs span two materials the robust loss lets them
/// go. Vertices of metal components take no part.
std::vector<AlbedoPair> albedoPairs(const Scene& scene, const MatteObservations& matte, const PairOptions& options);

/// Surfaces that face alike get the same light with the same error: waves of the mesh and coarse visibility. With n
/// observations that face alike (a soft cone, half at 20 degrees), their pairs weigh 1 / sqrt(n), and all pairs
/// together what they weighed before. Otherwise a wide floor outvotes whatever faces the light. Pairs of one vertex in
/// two lighting states stay as they are. O(256 observations + pairs).
void weighOrientations(const Scene& scene, const MatteObservations& matte, std::vector<AlbedoPair>& pairs);

/// What ratios of radiance are taken from. `skip`: per vertex 1 where an emitter or a candidate lies. `noMetals`: no
/// component is a metal, however much it differs between the views; what it looks like is the median of the views, as
/// on a matte surface.
struct RatioObservations {
    std::vector<uint8_t> skip;
    uint64_t seed = 0;
    bool noMetals = false;
    MatteObservations matte;
    std::vector<AlbedoPair> pairs;
};
RatioObservations ratioObservations(const Scene& scene, const RadianceSamples& samples, std::vector<uint8_t> skip,
                                    uint64_t seed, bool noMetals = false);

}  // namespace relamp
