// The first answer: coarse light, which emitters are emitters, strong directions finer than the rest, and lobes by a
// few observations.
#include "base/log.h"
#include "base/significant.h"
#include "solve/gloss/one_lobe.h"
#include "solve/steps/steps.h"

namespace relamp {

void coarseLight(SolveRun& s) {
    joinLikelyBounce(s);
    fitLight(s, {"light from ratios, coarse", s.in.options.startIterations, FitEnd::coarse});
    if (confirmEmitters(s)) {
        joinLikelyBounce(s);
        fitLight(s, {"light from ratios, coarse", s.in.options.startIterations, FitEnd::coarse});
    }
    for (int round = 0; round < 4 && fitUnknownLevels(s); ++round)
        fitLight(s, {"light from ratios, coarse", 6, FitEnd::coarse});
    keepFittedLevels(s);
    leaveOutBlackEnvironment(s);
    if (s.bounce.joined()) updateBounce(s);
    if (s.stopped()) return;
    const Lighting without = s.light.lighting;
    try {
        const Progress::Dispensable mayEnd(s.in.progress);
        decideBounce(s, true);
    } catch (const OutOfTime&) {
        s.light.lighting = without;
        s.bounce.forget("the time was used up before it could be tried");
    }
}

void sharpenStrong(SolveRun& s) {
    if (s.light.environmentBlack || s.light.firstLevel(s.in, s.hasMatte()) >= s.in.options.startLevel) return;
    double misfit = std::numeric_limits<double>::infinity();
    const bool byPeaks = s.in.options.meshError > 0;
    std::set<LeafCell> peaks;  // that were divided
    const int rounds = byPeaks ? StrongDirections::roundsByPeaks : StrongDirections::rounds;
    for (int round = 0; round < rounds && !s.stopped(); ++round) {
        const Irradiance irradiance = s.irradiance();
        // The measure is a root of squares: a fiftieth of the squares is worth another round. Where a mesh is off, most
        // squares are its own, and a sun is known by what its leaf's division does: one or two parts take its light.
        const double before = misfit;
        misfit = s.mismatch(irradiance);
        const bool explains = !(misfit * misfit > 0.98 * before * before);
        const std::vector<Rgb> fractions = contributionsOf(s, irradiance);
        const std::vector<uint32_t> strong =
            leavesToDivide(s.light.lighting.leaves, fractions, explains, byPeaks ? &peaks : nullptr);
        if (strong.empty()) return;
        s.splitLeaves(strong);
        fitLight(s, {"light from ratios, coarse", 4, FitEnd::coarse});
        if (!s.stopped()) s.light.keepForCut(s.in);
    }
}

void firstSurfaces(SolveRun& s) {
    if (s.stopped()) return;
    GlossOptions options;
    options.seed = s.in.options.seed;
    options.rows = s.rowOptions();
    options.rows.lobeSamples = 48;
    options.rows.cosineSamples = 24;
    options.rows.emitterSamples = 16;
    options.maxVertices = 120;
    const std::vector<size_t> sizes = observationsOfComponents(s.in.scene, s.observed.matte);
    s.gloss.early.clear();
    for (uint32_t p = 0; p < s.in.scene.materials; ++p) {
        if (!s.observed.matte.componentGlossy[p] || sizes[p] < 30) continue;
        const bool metal = s.observed.matte.componentGlossy[p] == 2;
        options.leastGain = leastGainOf(s, p);
        options.lambertGain = metal ? 1e30f : 1.6f;
        ComponentGloss g =
            fitGloss(s.in.capture, s.in.scene, s.in.samples, s.emitters.surfaces, s.emitters.clusters.emitterOfTriangle,
                     s.light.lighting, builtInBasis(), p, options, s.in.progress);
        if (g.lobe) s.gloss.early.push_back(std::move(g));
    }
}

void startLight(SolveRun& s) {
    if (s.light.environmentBlack) return;
    std::vector<uint32_t> coarse;
    for (uint32_t i = 0; i < s.light.lighting.leaves.size(); ++i)
        if (s.light.lighting.leaves[i].level < s.in.options.startLevel) coarse.push_back(i);
    s.meter.begin(Stage::visibility);
    s.light.learnVisibility(s.in, s.light.visibilityStepFor(s.in, s.hasMatte(), s.in.options.startLevel));
    s.meter.begin(Stage::light);
    if (!coarse.empty()) s.splitLeaves(coarse);
    fitLight(s, {"light from ratios", s.in.options.startIterations});
}

void leaveOutBlackEnvironment(SolveRun& s) {
    if (s.emitters.surfaces.empty() || s.observed.matte.radiance.empty()) return;
    double distant = 0, all = 0;
    for (size_t r = 0; r < s.light.influence.rows; ++r)
        for (size_t k = 0; k < s.light.influence.columns; ++k) {
            const bool leaf = k < s.light.lighting.leaves.size();
            const double light = double(s.light.influence.row(r)[k]) *
                                 luminance(leaf ? s.light.lighting.leafRadiance[k]
                                                : s.light.lighting.emitterRadiance[k - s.light.lighting.leaves.size()]);
            all += light;
            if (leaf) distant += light;
        }
    logInfo("distant light gives {} % of the light on the surfaces",
            significant(all > 0 ? 100 * distant / all : 0.0, 2));
    // Where the background is seen and black, a little light from beside it is what the fit could not place.
    const double background = backgroundOverSurfaces(s.in.samples, s.observed.matte, s.in.options.meshError > 0);
    const bool black = background >= 0 && background < 0.05;
    if (!(distant < (black ? 0.03 : 0.005) * all)) return;
    s.light.environmentBlack = true;
    std::fill(s.light.lighting.leafRadiance.begin(), s.light.lighting.leafRadiance.end(), Rgb(0));
}

bool startFromConstantReflectance(SolveRun& s) {
    // The component with the most observations stands for the scene.
    std::vector<size_t> observationsOf(s.in.scene.materials, 0);
    for (uint32_t v : s.observed.matte.vertices) observationsOf[s.in.scene.material[v]] += s.in.samples.countOf(v);
    const uint32_t component =
        uint32_t(std::max_element(observationsOf.begin(), observationsOf.end()) - observationsOf.begin());
    GlossOptions options;
    options.seed = s.in.options.seed;
    options.maxVertices = 1000;
    options.rows = s.rowOptions();
    const std::vector<GlossyObservation> observations =
        glossyObservations(s.in.capture, s.in.scene, s.in.samples, component, options);
    if (observations.size() < 40) {
        fitLight(s, {"light from ratios", s.in.options.startIterations});
        return true;
    }
    double best = 1e300;
    Lighting bestLighting = s.light.lighting;
    ComponentGloss chosen;
    chosen.component = component;
    chosen.matte = false;
    chosen.observations = observations;
    const auto attempt = [&](const Lobe& lobe) {
        const InfluenceMatrix rows =
            glossyRows(s.in.scene, s.emitters.surfaces, s.emitters.clusters.emitterOfTriangle, s.light.lighting.leaves,
                       lobe, observations, options.rows, s.in.progress);
        const OneLobeFit fit = fitOneLobe(rows, observations, s.light.anchors, s.light.lighting, s.in.progress);
        s.stability.kktResidual = std::max(s.stability.kktResidual, fit.kktResidual);
        if (!(fit.residual < best)) return false;
        best = fit.residual;
        bestLighting = fit.lighting;
        chosen.lobe = lobe;
        chosen.weight = fit.weight;
        chosen.residual = float(fit.residual);
        return true;
    };
    for (size_t k = 1; k < s.in.options.basis.lobes.size(); ++k)
        if ((s.in.options.basis.lobes[k].kind == Lobe::Kind::ggx ||
             s.in.options.basis.lobes[k].kind == Lobe::Kind::measured) &&
            !(chosen.lobe && s.stopped()))
            attempt(s.in.options.basis.lobes[k]);
    if (!chosen.lobe) {
        fitLight(s, {"light from ratios", s.in.options.startIterations});
        return true;
    }
    const InfluenceMatrix chosenRows =
        glossyRows(s.in.scene, s.emitters.surfaces, s.emitters.clusters.emitterOfTriangle, s.light.lighting.leaves,
                   *chosen.lobe, observations, options.rows, s.in.progress);
    const MetalEvidence evidence = metalEvidence(chosenRows, bestLighting, observations);
    logInfo("one lobe explains the looks within {:.2f}, surfaces that look alike from everywhere within {:.2f}",
            evidence.asMetal, evidence.alikeFromEverywhere);
    if (evidence.asMetal >= evidence.alikeFromEverywhere) {
        s.gloss.noMetals = true;
        return false;
    }
    s.light.lighting = bestLighting;
    s.gloss.components.assign(1, chosen);
    logInfo("one lobe, {}: residual {:.2f}, weight {:.3f} {:.3f} {:.3f}", chosen.lobe->name, best, chosen.weight.x,
            chosen.weight.y, chosen.weight.z);
    // A mirror-like surface shows the environment sharper than matte ones do: halve the leaves everywhere.
    std::vector<uint32_t> all(s.light.lighting.leaves.size());
    for (uint32_t i = 0; i < all.size(); ++i) all[i] = i;
    s.splitLeaves(all);
    improveLight(s, s.in.options.refineIterations);
    return true;
}

bool confirmEmitters(SolveRun& s) {
    if (s.emitters.clusters.emitters.empty()) return false;
    const auto rowsOf = [&](const std::vector<uint32_t>& vertices) { return s.rowsOf(vertices); };
    if (!s.emitters.judge(s.in, s.light.lighting, rowsOf)) return false;
    s.light.computeNearField(s.in, s.emitters);
    observeAnew(s);
    rebuildRows(s);
    s.light.lighting.emitterRadiance = firstRadiance(s.emitters.clusters);
    return true;
}

}  // namespace relamp
