// Glossy surfaces: which lobes a component of surface has, how strong they are, and the rows its observations add to
// the lighting program.
#pragma once
#include <optional>

#include "base/progress.h"
#include "brdf/basis.h"
#include "capture/capture.h"
#include "radiance/samples.h"
#include "scene/scene.h"
#include "solve/gloss/matte.h"
#include "transport/incident.h"

namespace relamp {

/// A look at a vertex of a glossy component.
struct GlossyObservation {
    uint32_t vertex = 0, view = 0;
    Rgb radiance{0};
    float sigma = 0;  ///< standard deviation, radiance
    Vec3 towardEye{0};
    uint32_t state = 0;  ///< lighting state of the view

    /// Both have one matte part: of one vertex, under one light.
    bool sharesMatte(const GlossyObservation& other) const { return vertex == other.vertex && state == other.state; }
};

/// Lobes of one component: the same weights all over it, beside a Lambert albedo per vertex.
struct ComponentGloss {
    uint32_t component = 0;
    std::optional<Lobe> lobe;  ///< none: the component is matte
    Rgb weight{0};             ///< per channel
    bool matte = true;         ///< false: no Lambert part (metal)
    float residual = 0;        ///< robust mean squared residual in standard deviations, with the lobe
    float residualMatte = 0;   ///< and without any
    std::vector<GlossyObservation> observations;  ///< the observations used, at most maxLooks
};

struct GlossOptions {
    size_t maxVertices = 700;  ///< per component, spread evenly
    LobeRowOptions rows;
    uint64_t seed = 1;
    /// A Lambert part must lower the residual this many times to be taken for real: it has an unknown a vertex, a lobe
    /// alone one a channel.
    float lambertGain = 1.6f;
    /// Lobes one component may mix. With more than 1, or with a basis beyond the built-in kinds, the basis is pruned
    /// first (solve/lobe_choice.h).
    size_t mostLobes = 1;
    /// Lobes are tried on directions that all share first (ArrivingLight), roughness between those of the basis, too.
    /// The best of each kind is tried on its own where it comes within a twelfth of the best there: a fifth of the
    /// rays. Where even the best there explains too little, none is.
    bool screen = true;
    /// A lobe is kept where it lowers the residual to this part.
    float leastGain = 0.85f;
};

/// Adds those of one vertex: one for every view that sees it unclipped and well enough, by state.
void addObservations(const Capture& capture, const Scene& scene, const RadianceSamples& samples, uint32_t vertex,
                     std::vector<GlossyObservation>& observations);

/// Evenly spread observations of a component.
std::vector<GlossyObservation> glossyObservations(const Capture& capture, const Scene& scene,
                                                  const RadianceSamples& samples, uint32_t component,
                                                  const GlossOptions& options);

/// Where each vertex and state begins, and behind them the number of observations.
std::vector<size_t> startsOfVertices(const std::vector<GlossyObservation>& observations);

/// Fits each lobe of the basis to the component under known light, with the Lambert part of every vertex eliminated,
/// refines the roughness of the best one, and keeps it where it explains the change between views. A basis of other
/// kinds than bare and dielectric GGX is pruned to a few candidates first, single lobes and mixtures; a mixture must
/// lower the residual by a twentieth against fewer lobes. Cost: about 3 rows an observation, without `options.screen` 4
/// more than there are lobes. Memory: ArrivingLight of options.maxVertices vertices.
ComponentGloss fitGloss(const Capture& capture, const Scene& scene, const RadianceSamples& samples,
                        const std::vector<EmitterSurface>& emitters, const std::vector<int>& emitterOfTriangle,
                        const Lighting& lighting, const BrdfBasis& basis, uint32_t component,
                        const GlossOptions& options, Progress& progress);

/// What a component's observations leave unexplained, robust mean square in standard deviations: by one lobe without a
/// Lambert part under known light; and by a surface that looks alike from everywhere, an unknown a vertex taken off the
/// count of observations. Where the second is not larger the component changes with the view, but not as a metal does:
/// its geometry or its cameras are off.
struct MetalEvidence {
    double asMetal = 0, alikeFromEverywhere = 0;
};
MetalEvidence metalEvidence(const InfluenceMatrix& rows, const Lighting& lighting,
                            const std::vector<GlossyObservation>& observations);

/// The lobe with its roughness multiplied by `factor`, kept within 0.06 to 0.9, and named after it. Lobes without a
/// roughness of their own (Lafortune, measured, mixtures) come back as they are.
Lobe withRoughness(const Lobe& lobe, float factor);

/// Rows of one lobe for the given observations; `mirrored`, if not null: what it shows of other surfaces in each, by
/// `options.outgoing`.
InfluenceMatrix glossyRows(const Scene& scene, const std::vector<EmitterSurface>& emitters,
                           const std::vector<int>& emitterOfTriangle, const LightLeaves& leaves, const Lobe& lobe,
                           const std::vector<GlossyObservation>& observations, const LobeRowOptions& options,
                           Progress& progress, std::vector<Rgb>* mirrored = nullptr);

}  // namespace relamp
