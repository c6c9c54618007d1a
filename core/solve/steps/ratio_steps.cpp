// Fits of the light to ratios of radiance, as far as the step that asks needs them.
#include "base/log.h"
#include "base/random.h"
#include "solve/gloss/one_lobe.h"
#include "solve/steps/steps.h"

namespace relamp {
namespace {

/// How far shape and place of a reconstructed mesh change what one light gives a vertex: residuals of hue where lights
/// of several hues mix say 3 % (statuette-pg).
constexpr float inexactLight = 0.03f;

}  // namespace

AlbedoFreeReport fitLight(SolveRun& s, const RatioFitRequest& request) {
    std::optional<ViewRows> withPatches;
    if (patchesTakePart(s)) withPatches = addPatchRows(s, request.views);
    const ViewRows* views = withPatches ? &*withPatches : request.views;
    const MetalRatios* metals = request.metals;
    AlbedoFreeOptions o;
    o.chroma = request.chroma;
    if (s.in.options.meshError > 0) o.lightError = inexactLight;
    o.iterations = request.iterations;
    // Light is soft when metals first join: their observations are far off and would be taken for outliers.
    const bool firstOfMetals = metals && !s.gloss.joined;
    s.gloss.joined |= metals != nullptr;
    const bool guessed = s.timeline.empty() && !s.light.startsFromPlan;
    o.anneal = guessed || firstOfMetals;
    o.leastIterations = guessed ? 4 : s.timeline.empty() ? 1 : 0;
    o.light = s.light.prior;
    o.emptyColumns = s.in.choices.emptyColumns;
    // Light that goes on to be made finer or tried out need not be fitted to the end.
    o.leastGain = request.end != FitEnd::last && !request.views && !s.in.choices.lastDigits
                      ? (request.end == FitEnd::coarse ? 1e-2f : 3e-4f)
                      : 0.0f;
    o.closing = request.end != FitEnd::coarse;
    if (metals) {
        o.fold = metals->fold;
        o.foldedRows = s.light.influence.rows;
    }
    const std::vector<Rgb>& bounce = metals ? metals->bounce : s.bounce.atObservation;
    o.bounce = bounce.empty() ? nullptr : &bounce;
    LightInformation earlier;
    std::swap(earlier, s.light.information);
    if (!s.in.progress.hasBudget()) earlier = {};  // as large as what takes its place
    const InfluenceRows rows =
        metals ? InfluenceRows(s.light.influence, metals->rows) : InfluenceRows(s.light.influence);
    AlbedoFreeReport report = solveAlbedoFree(
        rows, metals ? metals->observations : s.observed.matte, metals ? metals->pairs : s.observed.pairs,
        s.light.anchors, views, o, s.light.lighting, s.in.progress,
        [&](int i, double objective, double rmse) { s.record(request.stage, i, objective, rmse); });
    s.stability.kktResidual = report.kktResidual;
    // Cut before its first step, a fit says nothing of what fixes the light.
    const bool same = earlier.all.size() == report.information.all.size();
    s.light.information = same && report.iterations == 0 ? std::move(earlier) : std::move(report.information);
    s.light.unfinished = report.endedEarly;
    // While light is coarse, the bright part of a sky that nobody sees takes on the brightness of what is seen beside
    // it.
    if (!s.bounce.joined() && request.end != FitEnd::coarse && request.mayRefuteBackground &&
        s.light.refuteBackground(s.in, s.emitters, s.observed.matte)) {
        RatioFitRequest again = request;
        again.iterations = std::max(request.iterations, 4);
        return fitLight(s, again);
    }
    logInfo(
        "{}: {} iterations, objective {:.4g}, {} unknowns, chroma {:.3f} of the noise and {:.3f} of the rest, {:.1f} s",
        request.stage, report.iterations, report.objective, s.light.lighting.leaves.size() + s.emitters.surfaces.size(),
        report.chroma.noise, report.chroma.model, s.in.progress.seconds());
    return report;
}

void finishLight(SolveRun& s) {
    if (!s.light.unfinished || s.stopped() || s.light.environmentBlack) return;
    fitLight(s, {"light from ratios", s.in.options.refineIterations, FitEnd::last});
}

void improveLight(SolveRun& s, int iterations) {
    if (s.stopped() || s.light.environmentBlack) return;
    if (s.gloss.empty()) {
        fitLight(s, {"light from ratios", iterations});
        return;
    }
    if (!s.hasMatte() && s.gloss.components.size() == 1 && !s.gloss.components[0].matte) {
        ComponentGloss& g = s.gloss.components[0];
        Lighting bestLighting = s.light.lighting;
        double best = 1e300;
        const Lobe start = *g.lobe;
        // The roughness moves with the light: a blurred environment looks like a rough surface.
        for (float factor : {1.0f, 1.08f, 1 / 1.08f}) {
            if (s.stopped() && best < 1e300) break;
            const Lobe lobe = withRoughness(start, factor);
            if (factor != 1 && lobe.alpha == start.alpha) continue;
            const InfluenceMatrix rows =
                glossyRows(s.in.scene, s.emitters.surfaces, s.emitters.clusters.emitterOfTriangle,
                           s.light.lighting.leaves, lobe, g.observations, s.rowOptions(), s.in.progress);
            const OneLobeFit fit = fitOneLobe(rows, g.observations, s.light.anchors, s.light.lighting, s.in.progress);
            s.stability.kktResidual = std::max(s.stability.kktResidual, fit.kktResidual);
            if (!(fit.residual < best)) continue;
            best = fit.residual;
            bestLighting = fit.lighting;
            g.lobe = lobe;
            g.weight = fit.weight;
            g.residual = float(best);
        }
        s.light.lighting = bestLighting;
        s.record("light and one lobe", int(s.timeline.size()), best, 0);
        logInfo("one lobe, {}: residual {:.2f}, weight {:.3f} {:.3f} {:.3f}, {} unknowns, {:.1f} s", g.lobe->name, best,
                g.weight.x, g.weight.y, g.weight.z, s.light.lighting.leaves.size() + s.emitters.surfaces.size(),
                s.in.progress.seconds());
        return;
    }
    const ViewRows rows = viewRows(s, s.in.progress);
    std::optional<MetalRatios> metals = metalRatios(s);
    if (metals && !s.in.choices.mattePointsInDetail) metals->fold = leavesAsMatteTellsThem(s, s.irradiance());
    fitLight(s, {"light from ratios and gloss", iterations, FitEnd::usual, &rows, metals ? &*metals : nullptr});
}

std::optional<MetalRatios> metalRatios(SolveRun& s) {
    if (!s.gloss.hasMetal()) return {};
    MetalRatios all;
    all.rows.columns = s.light.influence.columns;
    all.observations = s.observed.matte;
    all.pairs = s.observed.pairs;
    all.bounce = s.bounce.atObservation;
    // Noise in these rows would move the scale.
    LobeRowOptions fine = s.rowOptions();
    fine.lobeSamples *= 2;
    fine.cosineSamples *= 2;
    for (const ComponentGloss& g : s.gloss.components) {
        if (g.matte || g.observations.size() < 2) continue;
        std::vector<Rgb> mirrored;
        const InfluenceMatrix lobe =
            glossyRows(s.in.scene, s.emitters.surfaces, s.emitters.clusters.emitterOfTriangle, s.light.lighting.leaves,
                       *g.lobe, g.observations, fine, s.in.progress, &mirrored);
        const size_t first = all.observations.vertices.size(), count = g.observations.size();
        all.rows.values.insert(all.rows.values.end(), lobe.values.begin(), lobe.values.end());
        all.rows.rows += count;
        for (size_t i = 0; i < count; ++i) {
            all.observations.vertices.push_back(g.observations[i].vertex);
            all.observations.radiance.push_back(g.observations[i].radiance);
            all.observations.sigma.push_back(Rgb(g.observations[i].sigma));
            if (!all.bounce.empty()) all.bounce.push_back(mirrored[i]);
            // Four partners for each: an observation stands in eight pairs, which together weigh as much as it would
            // with a known weight.
            for (uint64_t k = 1; k <= 4; ++k) {
                const size_t other = mixBits((s.in.options.seed + k) * 0x1000003 + i) % count;
                if (other != i) all.pairs.push_back({uint32_t(first + i), uint32_t(first + other), 0.25f});
            }
        }
    }
    return all;
}

ViewRows viewRows(SolveRun& s, Progress& progress) {
    ViewRows result;
    size_t total = 0;
    for (const ComponentGloss& g : s.gloss.components) total += g.matte ? g.observations.size() : 0;
    const size_t columns = s.light.lighting.leaves.size() + s.emitters.surfaces.size();
    for (InfluenceMatrix& m : result.influence) {
        m.rows = total;
        m.columns = columns;
        m.values.assign(total * columns, 0.0f);
    }
    size_t at = 0;
    GlossOptions options;
    options.rows = s.rowOptions();
    for (const ComponentGloss& g : s.gloss.components) {
        if (!g.matte) continue;
        std::vector<Rgb> mirrored;
        const InfluenceMatrix lobe =
            glossyRows(s.in.scene, s.emitters.surfaces, s.emitters.clusters.emitterOfTriangle, s.light.lighting.leaves,
                       *g.lobe, g.observations, options.rows, progress, &mirrored);
        std::vector<uint32_t> vertices;
        for (const GlossyObservation& observation : g.observations) vertices.push_back(observation.vertex);
        InfluenceMatrix lambert = s.rowsOf(vertices);
        for (size_t i = 0; i < g.observations.size(); ++i, ++at) {
            const size_t state = g.observations[i].state;
            s.emitters.dim(lambert.row(i), s.light.lighting.leaves, state);
            const Rgb albedo =
                !s.surfaces.albedo.albedo.empty() ? s.surfaces.albedo.albedo[g.observations[i].vertex] : Rgb(0);
            for (int c = 0; c < 3; ++c)
                for (size_t k = 0; k < columns; ++k)
                    result.influence[c].row(at)[k] = g.weight[c] * lobe.row(i)[k] + albedo[c] * lambert.row(i)[k];
            result.radiance.push_back(
                g.observations[i].radiance - g.weight * mirrored[i] -
                (s.bounce.atVertex.empty()
                     ? Rgb(0)
                     : albedo * s.bounce.atVertex[state * s.in.scene.mesh.vertexCount() + g.observations[i].vertex]));
            result.sigma.push_back(2.0f * g.observations[i].sigma);
        }
    }
    return result;
}

}  // namespace relamp
