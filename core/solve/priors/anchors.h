// Light seen directly: unclipped pixels on an emitter are its radiance, background pixels are the environment.
// Near-equalities; clipped ones are lower bounds (docs/method.md 3 and 6).
#pragma once
#include "clusters/emitter_clusters.h"
#include "radiance/samples.h"
#include "transport/lighting.h"

namespace relamp {

struct LeafAnchor {
    Rgb radiance{0};
    float coverage = 0;  ///< fraction of the leaf that background pixels cover, 0: unobserved
    bool clipped = false;
    float area = 0;  ///< of it that is seen, steradians

    /// Whether enough of it is seen to say anything.
    bool seen() const { return coverage > 0.05f; }
};

/// What a light probe holds of each leaf (solve/probe).
struct ProbeAnchor {
    std::vector<Rgb> radiance;  ///< mean over what is held of the leaf, in the photographs' unit
    std::vector<float> held;    ///< fraction of the leaf
    float noise = 0;            ///< relative deviation of a leaf
    float gainSigma = 0;        ///< of one factor on all of them, relative; 0: nothing but the fit tells it
};

struct LightAnchors {
    std::vector<LeafAnchor> leaves;
    std::vector<ProbeAnchor> probes;
    std::vector<Rgb> emitterRadiance;
    std::vector<float> emitterSigma;      ///< relative
    std::vector<uint8_t> emitterClipped;  ///< 1: a lower bound
};

/// Where a fit starts: what was seen of each emitter, or guessed.
std::vector<Rgb> firstRadiance(const EmitterClusters& clusters);

/// Does light seen directly tie the scale of all light down? An emitter that was seen does, clipped or not (a lower
/// bound), and a light probe whose exposure is known. Background does unless it is a backdrop: too small or too black
/// beside the surfaces (`darkness`: LightPriorOptions) to give even three thousandths of the light on the brightest, so
/// what lights them comes from elsewhere.
bool tiesScale(const LightAnchors& anchors, float darkness);

LightAnchors lightAnchors(const RadianceSamples& samples, const EmitterClusters& clusters, const LightLeaves& leaves);

}  // namespace relamp
