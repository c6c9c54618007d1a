// Parts of a connected component that mirror the light, beside parts that do not: a scan joins objects and table into
// one surface.
#pragma once
#include "base/progress.h"
#include "capture/capture.h"
#include "radiance/samples.h"
#include "scene/scene.h"
#include "solve/gloss/matte.h"
#include "transport/incident.h"

namespace relamp {

struct GlossyRegion {
    uint32_t component = 0;
    std::vector<uint32_t> vertices;
    double evidence = 0;  ///< logarithm of how much likelier its observations are with a lobe than without
    bool whole = false;   ///< most of the component
};

struct GlossyRegionOptions {
    uint64_t seed = 1;
    size_t mostObservations = 60000;
    double leastEvidence = 8;   ///< of a region
    double overChance = 2;      ///< times the evidence of the likeliest region of negative weight
    size_t leastVertices = 60;  ///< of a region
    float largestPart = 0.6f;   ///< of a component: what is more is the component, not a part of it
    double parting = 0.5;       ///< what each edge of the mesh across a border on an even surface costs
    double worstCell = 2;       ///< evidence against a lobe that one cell may have: its normals may be off
};

/// May a component of a few hundred vertices have parts that shine? Its observations change with the view more than
/// noise lets them, and on an exact mesh neither on a few vertices alone, at edges and shadows, nor on most. `exact`:
/// of the mesh. Cost: one pass over the samples.
bool mayHaveParts(const Scene& scene, const RadianceSamples& samples, const std::vector<uint8_t>& skip, bool exact);

/// How observations change with the view is held against what dielectric lobes of six widths would show under
/// `lighting` [Walter07], coarse light as a pilot finds it. Each cell of the surface has a likelihood for being coated,
/// over all widths and weights, its Lambert part free at every vertex. The minimum cut [Greig89] puts borders where
/// colour or shape changes. What is no likelier than chance is left out, and chance is what lobes of negative weight
/// explain [Elias07]. `skip`: per vertex 1 where an emitter lies. Cost: 88 rays an observation, 3 s for 60000.
/// The same bits on any number of threads. Throws Cancelled.
std::vector<GlossyRegion> glossyRegions(const Capture& capture, const Scene& scene, const RadianceSamples& samples,
                                        const std::vector<EmitterSurface>& emitters,
                                        const std::vector<int>& emitterOfTriangle, const MatteObservations& matte,
                                        const std::vector<uint8_t>& skip, const Lighting& lighting,
                                        const GlossyRegionOptions& options, Progress& progress);

}  // namespace relamp
