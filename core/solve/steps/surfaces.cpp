// Reflectance under the light found: lobes, coatings, albedo, and how smooth light and albedo are.
#include "base/log.h"
#include "solve/albedo/above_white.h"
#include "solve/albedo/shadow_edges.h"
#include "solve/gloss/matte_under_gloss.h"
#include "solve/light/lighting_step.h"
#include "solve/priors/prior_strength.h"
#include "solve/steps/steps.h"

namespace relamp {

/// Normals of a scan are off, and highlights lie elsewhere: a lobe explains less of what is known to shine.
float leastGainOf(const SolveRun& s, uint32_t material) { return s.in.scene.shines[material] ? 0.95f : 0.85f; }

void solveReflectance(SolveRun& s) {
    finishVisibility(s);
    Irradiance irradiance = s.irradiance();
    if (s.bounce.joined() && s.bounce.fraction == 0)
        s.bounce.fraction = bouncedFractionOf(s.bounce.atObservation, irradiance);
    // Glossy components: which lobe, how strong.
    std::vector<ComponentGloss> found;
    std::vector<uint8_t> fitted(s.in.scene.materials, 0);
    GlossOptions glossOptions;
    glossOptions.seed = s.in.options.seed;
    glossOptions.rows = s.rowOptions();
    glossOptions.mostLobes = s.in.options.mostLobes;
    glossOptions.screen = !s.in.choices.lostLobes;
    if (!s.hasMatte()) glossOptions.maxVertices = 1500;
    const std::vector<size_t> sizes = observationsOfComponents(s.in.scene, s.observed.matte);
    for (uint32_t p = 0; p < s.in.scene.materials && !s.stopped(); ++p) {
        if ((!s.observed.matte.componentGlossy[p] && !s.in.choices.matteComponents) || sizes[p] < 30) continue;
        const bool metal = s.hasMatte() && s.observed.matte.componentGlossy[p] == 2;
        // Light that a probe holds fast leaves more for a free matte part of every vertex to take up.
        const bool suspect = metal || (!s.hasMatte() && !s.in.options.probes.empty());
        glossOptions.leastGain = leastGainOf(s, p);
        glossOptions.lambertGain = metal && !s.gloss.heard ? 1e30f : suspect ? 3.0f : 1.6f;
        ComponentGloss g;
        try {
            const Progress::Dispensable mayEnd(s.in.progress);
            g = fitGloss(s.in.capture, s.in.scene, s.in.samples, s.emitters.surfaces,
                         s.emitters.clusters.emitterOfTriangle, s.light.lighting, s.in.options.basis, p, glossOptions,
                         s.in.progress);
        } catch (const OutOfTime&) { break; }
        fitted[p] = 1;
        if (!g.lobe) {
            logInfo("material {}: no lobe explains it, residual {:.2f} of {:.2f}", p, g.residual, g.residualMatte);
            continue;
        }
        logInfo("material {}: {} weight {:.3f} {:.3f} {:.3f}{}, residual {:.2f} of {:.2f}", p, g.lobe->name,
                g.weight.x, g.weight.y, g.weight.z, g.matte ? " over Lambert" : "", g.residual, g.residualMatte);
        found.push_back(std::move(g));
    }
    // A component that the time left unfitted stays as it was.
    const bool hurry = s.stopped() && !s.gloss.early.empty();
    for (ComponentGloss& g : s.gloss.empty() ? s.gloss.early : s.gloss.components)
        if (!fitted[g.component]) found.push_back(std::move(g));
    s.gloss.early.clear();
    s.gloss.settled = !s.gloss.empty() && s.gloss.sameCoatings(found);
    s.gloss.components = std::move(found);
    for (uint32_t p = 0; p < s.in.scene.materials; ++p)
        fitted[p] = fitted[p] && std::none_of(s.gloss.components.begin(), s.gloss.components.end(),
                                              [&](const ComponentGloss& g) { return g.component == p; });
    if (hurry || !s.stopped()) removeCoatings(s, hurry, fitted);
    if (!s.gloss.heard && !s.stopped() && sharpenForMetals(s)) irradiance = s.irradiance();
    s.gloss.heard = true;
    updateAlbedo(s, irradiance);
    askAlbedoStrength(s, irradiance);
    s.record("reflectance", int(s.timeline.size()), 0, s.mismatch(irradiance));
}

void removeCoatings(SolveRun& s, bool hurry, const std::vector<uint8_t>& matteAfterAll) {
    s.observed.backToPhotographed();
    s.observed.readAsMatte(s.in, matteAfterAll);
    for (const ComponentGloss& g : s.gloss.components) {
        if (!g.lobe || !g.matte || (s.stopped() && !hurry)) continue;
        s.observed.keepAsPhotographed();
        MatteUnderGlossOptions options;
        options.rows = s.rowOptions();
        // Every observation has a row here: fewer directions will do, because they are averaged.
        options.rows.lobeSamples = hurry ? 16 : 48;
        options.rows.cosineSamples = hurry ? 8 : 24;
        options.rows.emitterSamples = hurry ? 8 : 16;
        matteUnderGloss(s.in.capture, s.in.scene, s.in.samples, s.emitters.surfaces,
                        s.emitters.clusters.emitterOfTriangle, s.light.lighting, g, options, s.observed.matte,
                        s.in.progress);
    }
}

void askLightStrength(SolveRun& s) {
    if (!s.in.options.askForStrength || s.in.options.lightSmoothness > 0 || !s.hasMatte() || !s.in.options.nearField ||
        s.light.environmentBlack || s.stopped())
        return;
    constexpr size_t maxRows = 6000;
    std::vector<Vec3> positions(s.observed.matte.vertices.size());
    for (size_t i = 0; i < positions.size(); ++i)
        positions[i] = s.in.scene.mesh.positions[s.observed.matte.vertices[i]] * s.in.scene.axes;
    AlbedoFreeOptions o;
    o.light = s.light.prior;
    o.emptyColumns = s.in.choices.emptyColumns;
    o.bounce = s.bounce.offset();
    s.light.takeStrength(testLightStrength(s.light.influence, s.observed.matte, s.observed.pairs, positions,
                                           s.light.anchors, o, s.light.lighting, maxRows, s.in.progress));
    for (const PriorStrength::Trial& t : s.light.smoothness.trials)
        logInfo("light {:.2g} times as smooth: misfit of pairs left out {:.4f} +- {:.4f}", t.factor, t.misfit, t.error);
}

void askAlbedoStrength(SolveRun& s, const Irradiance& irradiance) {
    if (!s.in.options.askForStrength || s.in.options.albedoSmoothness > 0 || !s.surfaces.smoothness.trials.empty() ||
        s.observed.matte.vertices.empty() || s.stopped())
        return;
    const std::vector<Rgb> sigma = unsureIrradiance(s, irradiance).sigma;
    s.surfaces.take(testAlbedoStrength(s.in.scene, s.in.samples, s.observed.matte, irradiance.value, sigma,
                                       s.surfaces.prior, s.surfaces.albedo.albedo, s.in.options.seed, s.in.progress),
                    s.in.options.prior);
    for (const PriorStrength::Trial& t : s.surfaces.smoothness.trials)
        logInfo("surfaces {:.2g} times as smooth: misfit of observations left out {:.4f} +- {:.4f}", t.factor, t.misfit,
                t.error);
    if (s.surfaces.smoothness.factor != 1) updateAlbedo(s, irradiance);
}

bool mayShowEmitters(const SolveRun& s) { return s.in.options.meshError > 0 && !s.emitters.surfaces.empty(); }

namespace {

/// What the model does not hold of the light is a part of the light there is, not of what arrives: in a state without
/// distant light a vertex in shadow shows hardly more than that, and another state tells its albedo.
void unsureInTheDark(const SolveRun& s, Irradiance& irradiance) {
    constexpr float missing = 0.01f;
    std::vector<Rgb> brightest(s.in.scene.mesh.vertexCount(), Rgb(0));
    const std::vector<uint32_t>& vertices = s.observed.matte.vertices;
    for (size_t i = 0; i < vertices.size(); ++i)
        brightest[vertices[i]] = glm::max(brightest[vertices[i]], irradiance.value[i]);
    for (size_t i = 0; i < vertices.size(); ++i) {
        const Rgb off = missing * (brightest[vertices[i]] - irradiance.value[i]);
        irradiance.sigma[i] = glm::sqrt(irradiance.sigma[i] * irradiance.sigma[i] + off * off);
    }
}

}  // namespace

Irradiance unsureIrradiance(const SolveRun& s, const Irradiance& known) {
    Irradiance irradiance = unsureAtShadows(s.in.scene, s.observed.matte, known);
    if (!s.in.samples.environmentOfState.empty()) unsureInTheDark(s, irradiance);
    return mayShowEmitters(s) ? unsureAboveWhite(s.observed.matte, std::move(irradiance)) : irradiance;
}

void updateAlbedo(SolveRun& s, const Irradiance& known) {
    const Irradiance irradiance = unsureIrradiance(s, known);
    s.surfaces.albedo =
        solveAlbedo(s.in.scene, s.observed.matte, irradiance.value, irradiance.sigma, s.surfaces.prior, s.in.progress);
    if (s.in.options.palette > 0)
        s.surfaces.albedo = solveAlbedoWithPalette(s.in.scene, s.observed.matte, irradiance.value, irradiance.sigma,
                                                   s.surfaces.prior, s.in.options.palette, std::move(s.surfaces.albedo),
                                                   s.surfaces.palette, s.in.progress);
    s.gloss.withoutMetals(s.in.scene, s.surfaces.albedo.albedo);
}

void startFromConstantAlbedo(SolveRun& s) {
    s.surfaces.albedo.albedo.assign(s.in.scene.mesh.vertexCount(), Rgb(0.5f));
    for (int round = 0; round < 3; ++round) alternate(s);
}

void alternate(SolveRun& s) {
    if (s.light.environmentBlack) return;
    // The step changes one channel after the other: nothing is taken over before all are there.
    Lighting improved = s.light.lighting;
    const LightPrior prior(s.light.lighting.leaves, s.light.anchors, s.light.prior, s.light.influence);
    const LightingStepReport step =
        lightingStep(s.light.influence, s.observed.matte, s.surfaces.albedo.albedo, s.irradiance().sigma, prior,
                     s.bounce.atObservation, improved, s.in.progress);
    s.light.lighting = std::move(improved);
    s.stability.kktResidual = step.kktResidual;
    const Irradiance irradiance = s.irradiance();
    updateAlbedo(s, irradiance);
    s.record("light and reflectance in turn", int(s.timeline.size()), step.after, s.mismatch(irradiance));
    logInfo("light and reflectance in turn: objective {:.4g} -> {:.4g}, rmse {:.3g}", step.before, step.after,
            step.rmse);
}

}  // namespace relamp
