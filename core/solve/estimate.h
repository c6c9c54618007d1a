// Room 6's product: what the solver found, with its history and how sure it is.
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "brdf/albedo_texture.h"
#include "brdf/basis.h"
#include "brdf/lobe_weights.h"
#include "clusters/emitter_clusters.h"
#include "image/panorama.h"
#include "solve/albedo/palette.h"
#include "solve/known_patch.h"
#include "solve/omission.h"
#include "solve/probe/probe_fit.h"
#include "solve/reproduction.h"
#include "solve/solve_plan.h"
#include "transport/lighting.h"

namespace relamp {

/// Non-negative weights of the basis lobes, per vertex and channel. Lobe 0 is Lambert: its weight is the diffuse
/// albedo.
struct Reflectance {
    BrdfBasis basis;
    StoredWeights weight;           ///< weight[k][vertex]; readers ask at() or lobe()
    std::vector<uint8_t> observed;  ///< views that saw the vertex
    std::vector<float> confidence;  ///< in [0, 1]: fraction of the vertex's albedo that comes from its own observations
    std::vector<float>
        sigma;  ///< relative standard deviation of the albedo, mean of the channels; empty where it was not assessed
    std::shared_ptr<const AlbedoTexture> texture;  ///< albedo finer than the vertices; null where there is none

    LobesAtVertex at(size_t vertex) const { return {weight, vertex}; }
    /// `corners`: a triangle of the mesh; `barycentric` as a Hit has it.
    LobesAtHit at(const std::array<uint32_t, 3>& corners, const Vec2& barycentric) const {
        return {weight, corners, barycentric};
    }
    /// One lobe at all vertices, for loops over them.
    const std::vector<Rgb>& lobe(size_t k) const { return weight[k]; }
    size_t lobes() const { return weight.size(); }
    size_t vertexCount() const { return weight.empty() ? 0 : weight[0].size(); }
};

/// One line of the timeline.
struct TimelineEntry {
    double seconds = 0;
    std::string stage;
    int iteration = 0;
    double objective =
        0;  ///< of the stage's own program; never rises while its unknowns stay the same; 0 where the stage has none
    double rmse = 0;  ///< relative: how far points of probably equal albedo differ under the light found, robust; the
                      ///< same in all stages and modes
};

/// How the light/albedo scale was fixed, per channel in words.
struct GaugeReport {
    std::string kind;      ///< "emitter", "background", "white-patch", "albedo", "assumed"
    std::string evidence;  ///< one sentence
    Rgb scale{1};          ///< factor that was applied to the lighting by a --gauge option
    Rgb sigma{0};          ///< relative standard deviation of the scale; 0 where it was not assessed
    Rgb fromEmitters{0}, fromBackground{0}, fromGloss{0}, fromBounces{0}, fromProbes{0},
        fromPatches{0};  ///< fractions of the evidence on the scale, together 1, or all 0
};

/// How strong a prior was, as a factor on its usual strength.
struct PriorStrength {
    struct Trial {
        float factor = 1;
        double misfit = 0;  ///< how badly data that were left out were predicted, over the usual strength's misfit
        double error = 0;   ///< standard error of that ratio
    };
    float factor = 1;
    std::string chosenBy = "usual";  ///< "usual", "photographs": those predicted what was left out clearly better with
                                     ///< another one, or "artist"
    std::vector<Trial> trials{};     ///< empty where the photographs were not asked
};

struct StabilityReport {
    double kktResidual = 0;      ///< worst channel of the last lighting program, relative
    double conditionNumber = 0;  ///< of the column-scaled lighting Gram matrix
    int effectiveRank = 0;       ///< its eigenvalues above 1e-6 of the largest
    int unknowns = 0;
    std::string reason;  ///< when a program did not converge
    std::vector<float>
        spectrum{};  ///< eigenvalues of that matrix over the largest, falling; at most 256 of them, evenly spread
    std::string weakest{};  ///< the change of light that the photographs tell least about, in words
    float weakestSigma =
        0;  ///< how much light on the surfaces it moves, root mean square, relative, one standard deviation
};

/// Light on the surfaces while the photographs were taken, per lighting state and vertex; empty where no solve has just
/// ended.
struct SurfaceLight {
    std::vector<std::vector<Rgb>> white;    ///< radiance of a white matte surface there, bounced light included; 0: not
                                            ///< known
    std::vector<std::vector<Rgb>> coating;  ///< radiance that a coating over the matte part adds, mean of the views
    uint32_t state = 0;                     ///< whose views were left out for HeldOutAlbedo
    bool empty() const { return white.empty(); }
};

/// What an emitter's form factor lacks at vertices close to it, because the mesh is inexact; holds while emitter and
/// vertex are where they were photographed. Per vertex, or empty.
struct NearFieldCorrection {
    std::vector<int> emitter;       ///< whose, -1: none
    std::vector<float> formFactor;  ///< added to it
    bool empty() const { return emitter.empty(); }
};

/// A lighting state of the photographs: emitters are switched between states, and the environment may be another one.
struct LightingState {
    std::string name;
    std::vector<std::string> views;  ///< names of its photographs
    int environment = 0;             ///< 0: Estimate::environment, k: otherEnvironments[k - 1], -1: none
};

/// The environment of lighting states that do not have Estimate::environment, in its cells.
struct StateLight {
    std::vector<Rgb> environment;
    std::vector<Rgb> sigma;  ///< standard deviation; empty where it was not assessed
    std::shared_ptr<const Panorama> background{};  ///< as Estimate::background
};

struct Estimate {
    Lighting lighting;
    Reflectance reflectance;
    NearFieldCorrection nearFieldCorrection;
    EmitterClusters emitters;      ///< final: candidates confirmed or rejected
    std::vector<Rgb> environment;  ///< mean radiance of each cell of the square of side environmentSide
    int environmentSide = 256;
    std::vector<Rgb> environmentSigma;  ///< its standard deviation, per cell, radiance; empty where it was not assessed
    /// What photographs show of it behind the scene, finer than the cells, which fill the rest; null: nothing.
    std::shared_ptr<const Panorama> background;
    std::vector<Rgb> emitterSigma;      ///< standard deviation of each emitter's radiance
    std::vector<LightingState> states;  ///< of the photographs, for EmitterCluster::inState; empty: there is one
    std::vector<StateLight> otherEnvironments;  ///< of states that have an environment of their own
    std::vector<float> identifiability;  ///< per emitter: fraction of its effect that no distant light can imitate
    std::vector<TimelineEntry> timeline;
    std::vector<LeftOut> leftOut;
    SolvePlan plan;  ///< what was decided beforehand, and what the stages cost
    GaugeReport gauge;
    std::vector<ProbeFit> probes;   ///< light probes that were given, used or not
    std::vector<PatchFit> patches;  ///< surfaces of known albedo that were given
    PriorStrength lightSmoothness, albedoSmoothness;
    std::vector<PaletteColour> palette;  ///< materials, where the artist said how many; most used first
    StabilityReport stability;
    SurfaceLight surfaceLight;           ///< for the texture, which takes it
    Reproduction reproduction;           ///< how well it explains its photographs; measured by the pipeline
    std::vector<HeldOutAlbedo> heldOut;  ///< for that measure, which takes them
    std::shared_ptr<const AlbedoTexture> heldOutTexture;  ///< the texture without the views of heldOut; for it too
    std::string mode;                                     ///< "near-field" or "distant-only"
    bool interreflection = false;  ///< the photographs hold light bounced between surfaces: relit frames have it too
    float bouncedFraction = 0;     ///< of the light on the surfaces seen, 0 without interreflection
    bool cancelled = false;        ///< stopped early: the best answer so far
};

}  // namespace relamp
