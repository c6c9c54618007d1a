// Room 4's product: the patches of surface that send light ([Put15] section 3.3), with the evidence for each.
#pragma once
#include <string>
#include <vector>

#include "base/progress.h"
#include "capture/capture.h"
#include "capture/emission_lobe.h"
#include "clusters/emission_pattern.h"
#include "radiance/samples.h"
#include "scene/scene.h"

namespace relamp {

/// Why a patch is taken for an emitter.
struct EmitterEvidence {
    float sceneContrast = 0;  ///< its radiance over the 95th percentile of the other surfaces
    float localContrast = 0;  ///< its radiance over the median of the surfaces around it
    float uniformity = 0;     ///< relative spread (robust standard deviation) of its radiance over the patch
    float viewSpread = 0;     ///< median relative difference of one vertex between views; differing exposures are in it
    bool viewsAgree =
        false;  ///< a quarter of its vertices or more were seen by two views, so that viewSpread means something
    float edgeDrop = 0;        ///< median radiance just outside over inside; 0 when it is an object of its own
    float demandedAlbedo = 0;  ///< albedo needed to explain it by reflection, 0 until a light fit has tested it
    int viewsSeen = 0;
    size_t samples = 0;         ///< observations on it
    float clippedFraction = 0;  ///< fraction of them at the clip level
};

/// A patch of emitting triangles of one radiance.
struct EmitterCluster {
    std::string id;                   ///< "emitter-1", strongest power first
    std::vector<uint32_t> vertices;   ///< sorted
    std::vector<uint32_t> triangles;  ///< sorted
    Rgb radiance{0};                  ///< seen directly, image units (median of unclipped observations)
    float radianceSigma = 0;          ///< relative standard deviation of that
    bool twoSided = false;            ///< its back was seen shining as well
    bool fitted = false;      ///< a ball that was fitted to the photographs: the mesh around it is not to be relied on
    bool unobserved = false;  ///< a proxy: no pixel tells its radiance, which is a guess until the light is solved
    Vec3 positionSigma{0};    ///< standard deviation of its centre, metres; 0 where the mesh says where it is
    Vec3 centroid{0};         ///< metres, area-weighted
    Vec3 normal{0};           ///< area-weighted mean, unit; 0 for closed parts
    float area = 0;           ///< square metres
    EmitterEvidence evidence;
    /// Of each of `vertices`: its radiance in parts of `radiance`, the mean over the surface; empty: it shines evenly.
    std::vector<float> level = {};
    std::shared_ptr<const EmissionPattern> pattern = {};  ///< the same for any point of the surface; null: evenly
    EmissionLobe lobe = {};  ///< how its radiance depends on direction; `radiance` is that along the axis
    /// In each lighting state of the capture, in parts of `radiance`, which it has where it is brightest; 0: off.
    /// Empty: it shines alike in all.
    std::vector<float> inState = {};
    float levelIn(size_t state) const { return inState.empty() ? 1.0f : inState[state]; }
};

struct RejectedPatch {
    Vec3 centroid{0};
    Rgb radiance{0};
    EmitterEvidence evidence;
    std::string reason;                     ///< for the report
    std::vector<uint32_t> besideBall = {};  ///< its vertices, where a fitted ball's light explains it
};

struct EmitterClusters {
    std::vector<EmitterCluster> emitters;    ///< accepted
    std::vector<EmitterCluster> candidates;  ///< bright, uniform patches that only a light fit can decide
    std::vector<RejectedPatch> rejected;
    std::vector<int> emitterOfVertex;    ///< -1: none
    std::vector<int> emitterOfTriangle;  ///< -1: none
};

struct ClusterOptions {
    float tolerance = 0.15f;     ///< relative radiance step inside a patch
    float certainContrast = 12;  ///< scene contrast above which no light fit is needed
    float minContrast = 1.6f;    ///< scene or local contrast below which a patch is no candidate
    float unevenContrast = 4;    ///< scene contrast above which a bright part of uneven radiance is a candidate
};

/// High-radiance patches: view-independent, uniform, with a sharp edge. Specular highlights move with the view and
/// fail; bright walls stay candidates until confirmEmitters has fitted the light. So do bright parts with a sharp edge
/// that are not uniform (a shade that glows more where the bulb is near, a window): as emitters they have one radiance,
/// their mean. And so do very bright ones that differ between the views as a whole and by less than half: photographs
/// whose exposures differ, emitters that shine more one way.
EmitterClusters clusterEmitters(const Scene& scene, const Capture& capture, const RadianceSamples& samples,
                                const ClusterOptions& options, Progress& progress);

/// Luminance of what the whole patch sends, up to a constant: the order of the list.
inline float emitterPower(const EmitterCluster& e) { return luminance(e.radiance) * e.area; }

/// Sets area, centroid and normal from its triangles. O(triangles of it).
void measureTriangles(const Scene& scene, EmitterCluster& cluster);

/// Fills emitterOfVertex / emitterOfTriangle, sorts by power (strongest first) and names the emitters.
void indexEmitters(const Scene& scene, EmitterClusters& clusters);

}  // namespace relamp
