// The steps of a solve and what they are made of: functions from the values of a SolveRun to its values. Not a door.
#pragma once
#include <set>

#include "solve/steps/solve_run.h"
#include "solve/uncertainty.h"

namespace relamp {

// run_step.cpp: one step, or as much of it as the time budget leaves. `index`: its place in the list.
void runStep(SolveRun& s, SolveStep step, uint32_t index);
/// Tells the listener how things stand.
void finishedStep(SolveRun& s, uint32_t next, SolveStep finished);

// begin.cpp: observations, pairs, transport and a first guess of the light; what follows from emitters and leaves.
void beginSolve(SolveRun& s, const EmitterClusters& clusters);
void observeAnew(SolveRun& s);
void rebuildRows(SolveRun& s);
/// The rays that coarse light did without, and the rows again.
void finishVisibility(SolveRun& s);

// resume.cpp
SolveCheckpoint checkpointOf(const SolveRun& s, uint32_t step, bool between);
/// beginSolve for a solve that stood at `checkpoint`.
void resumeSolve(SolveRun& s, const SolveCheckpoint& checkpoint);

// ratio_steps.cpp: fits of the light to ratios of radiance.
/// How far a fit of the light goes: light that strong directions are told from, light that finer fits or a choice
/// follow, light that stays.
enum class FitEnd { coarse, usual, last };
/// What metals add to a fit: their observations behind the matte ones, in rows of their own. The lobe's weight cancels
/// between two observations of one component, as albedo does, so the component says how the light is spread and has no
/// say in its scale.
struct MetalRatios {
    InfluenceMatrix rows;
    MatteObservations observations;  ///< matte and metal
    std::vector<AlbedoPair> pairs;
    std::vector<Rgb> bounce;
    std::vector<uint32_t> fold;  ///< AlbedoFreeOptions::fold of the rows without metals
};
struct RatioFitRequest {
    std::string stage;
    int iterations = 1;
    FitEnd end = FitEnd::usual;
    const ViewRows* views = nullptr;
    const MetalRatios* metals = nullptr;
    std::optional<ChromaFraction> chroma = {};
    bool mayRefuteBackground = true;  ///< false: light is too coarse to say that background does not light the scene
};
AlbedoFreeReport fitLight(SolveRun& s, const RatioFitRequest& request);
void improveLight(SolveRun& s, int iterations);
/// Fits the light to the end, where its last fit was ended early.
void finishLight(SolveRun& s);
/// Observations of components that have a matte part too, with their reflectance as it is now.
ViewRows viewRows(SolveRun& s, Progress& progress);
/// Those of components without one; nothing where there are none.
std::optional<MetalRatios> metalRatios(SolveRun& s);

// coarse_light.cpp
/// docs/method.md 11, on leaves of half the start level's side, and then at the start level.
void coarseLight(SolveRun& s);
void startLight(SolveRun& s);
/// Leaves that give much of the light are split down to a side of 64 before the others are: a sun or a window is in
/// its place early, and all that follows starts from there.
void sharpenStrong(SolveRun& s);
/// Lobes of the components that change with the view, by a few observations: shown, and kept until the surfaces step
/// finds better ones. Without them a metal is black. They have no say in the light: coarse light with metals in it
/// claims to know the scale to a tenth where it is off by half.
void firstSurfaces(SolveRun& s);
/// GlossOptions::leastGain for a material.
float leastGainOf(const SolveRun& s, uint32_t material);
/// Where nothing is matte: one constant lobe, light first; the lobe that explains the observations best is kept. False,
/// and nothing is changed but gloss.noMetals, where no lobe explains them better than a surface that looks alike from
/// everywhere.
bool startFromConstantReflectance(SolveRun& s);
/// True when the set of emitters changed.
bool confirmEmitters(SolveRun& s);
/// Leaves the environment out where it gives less than half a percent of what is seen (3 % where the background is seen
/// and black): less than the photographs can tell.
void leaveOutBlackEnvironment(SolveRun& s);

// state_agreement.cpp
/// Lighting states that share an environment, though ratios of radiance between them are more than 6 % off beyond noise
/// (median): warns of them and returns the warnings.
std::vector<std::string> statesThatDisagree(const SolveRun& s, const Irradiance& irradiance);

// unknown_levels.cpp
/// Levels that no photograph shows directly (EmitterCluster::inState below 0), from the ratios of radiance between
/// lighting states under the present light; rows follow. True when one changed by more than a hundredth.
bool fitUnknownLevels(SolveRun& s);
/// They are known from now on.
void keepFittedLevels(SolveRun& s);

// finer_light.cpp
/// Splits strong leaves; false when there is nothing left to split.
bool refineLeaves(SolveRun& s);
/// What each leaf gives of the light at a vertex, on average over the vertices.
std::vector<Rgb> contributionsOf(const SolveRun& s, const Irradiance& irradiance);
/// Per leaf 1 where it gives more than 0.4 of the light of the four that its parent was divided into.
std::vector<uint8_t> peaksAmongBrothers(const LightLeaves& leaves, const std::vector<Rgb>& fractions);
/// Environment, level and place of a leaf.
using LeafCell = std::tuple<int, int, int, int>;
/// Strong leaves whose light may be narrower than they are: all of them, if the last division `explained` more of the
/// photographs. Otherwise, and only with `divided` (an inexact mesh), peaks and the quarters of a peak: a sun on the
/// middle of a leaf gives each of them the same. `divided`: peaks of earlier rounds; those of this one are added.
std::vector<uint32_t> leavesToDivide(const LightLeaves& leaves, const std::vector<Rgb>& fractions, bool explained,
                                     std::set<LeafCell>* divided);
/// Leaves that only metals tell apart: brothers that were split for them, and that give matte surfaces too little light
/// for their split to matter. Per column of the rows its group; empty: none.
std::vector<uint32_t> leavesAsMatteTellsThem(const SolveRun& s, const Irradiance& irradiance);
/// A metal shows the environment sharper than matte surfaces do: leaves are halved to a side of 32 where neighbours
/// differ. True when it did.
bool sharpenForMetals(SolveRun& s);

// bounces.cpp
/// Do the photographs hold light bounced between surfaces? Fits the light with and without it and keeps what explains
/// ratios better. `coarse`: a first, cheap try that can only leave it out.
void decideBounce(SolveRun& s, bool coarse);
/// The part of the misfit without bounced light that may be left with it. `fraction`: of the light, that it gives then;
/// `predicted`: of the light as it was fitted without, which is `anchored` where background or emitters tell its scale.
double mostLeftByBounce(float fraction, float predicted, bool anchored);
/// Where the plan finds bounced light likely: what the photographs show of its senders joins the light from the start,
/// by few rays; finer light judges it (decideBounce).
void joinLikelyBounce(SolveRun& s);
/// Bounced light, if it was kept, from what the photographs show of its senders; senders that no photograph shows send
/// their albedo times their light.
void updateBounce(SolveRun& s);

// surfaces.cpp
void solveReflectance(SolveRun& s);
/// Whether the mesh is off, so that vertices may show the emitters beside them.
bool mayShowEmitters(const SolveRun& s);
/// `known` with the deviations of a mesh that is off: edges of shadows, and vertices that show an emitter beside them.
Irradiance unsureIrradiance(const SolveRun& s, const Irradiance& known);
/// Albedo of every vertex under `irradiance`; metals have none.
void updateAlbedo(SolveRun& s, const Irradiance& irradiance);
/// Takes what coatings reflect off the matte observations. `hurry`: with a third of the directions, though the time is
/// used up. `matteAfterAll`: per component 1 where no lobe explains its change with the view.
void removeCoatings(SolveRun& s, bool hurry, const std::vector<uint8_t>& matteAfterAll);
/// One round of [Put15] 3.2: light given reflectance, reflectance given light.
void alternate(SolveRun& s);
/// [Haber09]'s way in: constant albedo, light first.
void startFromConstantAlbedo(SolveRun& s);
void askLightStrength(SolveRun& s);
void askAlbedoStrength(SolveRun& s, const Irradiance& irradiance);

// closing: assemble.cpp, certainty.cpp, gauge.cpp, hold_out.cpp, references.cpp
/// Lighting, environment image, emitters and reflectance as they stand, before the gauge.
Estimate assemble(const SolveRun& s);
/// What background pixels show in a cell of a grid along the scene's axes, `leaf` holds it; none where none saw it.
std::optional<Rgb> backgroundAt(const SolveRun& s, const DirectionGrid& grid, size_t environment, int cell,
                                uint32_t leaf);
/// The environments of the lighting states in the order of an estimate's: first that of the main state.
std::vector<size_t> environmentsInOrder(const SolveRun& s);
/// From the square along the scene's axes to the world's.
void turnEnvironment(const SolveRun& s, Estimate& estimate);
/// Gives the listener, if there is one, an estimate as things stand; the values are afterwards as they were.
void showSnapshot(SolveRun& s);
Estimate finishSolve(SolveRun& s);
/// How well the lighting problem is conditioned, and what no environment can imitate of each emitter.
void assessConditioning(SolveRun& s, Estimate& estimate);
LightUncertainty uncertaintyOf(const SolveRun& s, const Irradiance& irradiance, bool scaleOnly);
/// How sure the light, the albedo and the environment image are.
void assessUncertainty(const SolveRun& s, const Irradiance& irradiance, const LightUncertainty& light,
                       Estimate& estimate);
/// Relative deviation of the scale of light at best: what gives a hundredth of the light cannot tell it better than the
/// model is right to a hundredth of itself. Fractions of the light: background that is `seen`, and `bounced`.
float scaleSigmaByModel(double seen, double bounced);
/// Whether the scale rests on light that may be a small part of all: background, where no `metal` mirrors it beside the
/// rest, or bounced light, which metal does not help.
bool restsOnPartOfLight(const LightUncertainty& light, bool metal);
/// A deviation of the scale with what the model of light is off by, where little of it is seen (docs/method.md 6.5).
Rgb widenedByModel(const SolveRun& s, const LightUncertainty& light, Rgb sigma);
/// Whether highlights alone would tell the scale, before a backdrop: they are as strong as their lobes' weights say,
/// and these are fitted, so that they tell none.
bool glossAlone(const LightUncertainty& light, bool backdrop);
void applyGauge(const SolveRun& s, const Irradiance& irradiance, const LightUncertainty& light, Estimate& estimate);
/// Asks once which patches of known albedo agree with the light that is fitted without them, and with each other. Those
/// that do not agree take part in no fit from now on; where all do, the light stays as it was.
void judgePatches(SolveRun& s);
/// Whether any does; until they are asked all do.
bool patchesTakePart(const SolveRun& s);
/// `views`, which may be null, and rows for the patches that take part: the mean radiance of nine parts of each, or of
/// all of a small one, in its photograph. Throws Error that names a patch in which no surface is seen.
ViewRows addPatchRows(SolveRun& s, const ViewRows* views);
/// What the light found, times the gauge's `scale`, makes of the patches; says so in the log, as a warning for those
/// that do not agree.
std::vector<PatchFit> patchesUnder(SolveRun& s, const Rgb& scale);
/// The part of the light's information that comes from patches, per channel, were none of them an outlier.
std::array<Eigen::MatrixXd, 3> patchInformation(SolveRun& s);
/// The part of the light's information that comes from light probes, per channel.
std::array<Eigen::MatrixXd, 3> probeInformation(const SolveRun& s);
/// How the probes that took part fit the light found, before the gauge.
std::vector<ProbeFit> probesUnder(const SolveRun& s, const Irradiance& irradiance);
/// Two views are held out in turn: albedo of all vertices without them, under the light that all views gave.
std::vector<HeldOutAlbedo> holdOutViews(const SolveRun& s, const Irradiance& irradiance);

}  // namespace relamp
