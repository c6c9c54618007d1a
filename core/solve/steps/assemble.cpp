// The estimate as things stand.
#include "base/log.h"
#include "solve/steps/steps.h"

namespace relamp {

namespace {

/// What of a leaf no pixel saw: the mean of the whole leaf is what was found, and the rest of it is known.
Rgb besideBackground(const SolveRun& s, size_t leaf) {
    constexpr float mostSeen = 0.9f;  // beyond it what is left would be a difference of two large numbers
    const LeafAnchor& anchor = s.light.anchors.leaves[leaf];
    const Rgb whole = s.light.lighting.leafRadiance[leaf];
    if (!anchor.seen() || anchor.coverage > mostSeen || anchor.clipped) return whole;
    return glm::max(whole - anchor.coverage * anchor.radiance, Rgb(0)) / (1 - anchor.coverage);
}

/// Of one environment, the radiance of the cells of the square.
std::vector<Rgb> environmentCells(const SolveRun& s, const DirectionGrid& fine, size_t environment) {
    std::vector<Rgb> cells(size_t(fine.cells())), rest;
    for (size_t leaf = 0; leaf < s.light.lighting.leaves.size(); ++leaf) rest.push_back(besideBackground(s, leaf));
    const std::vector<uint32_t> leafOf = s.light.lighting.leaves.leafOfCells(fine, environment);
    for (int c = 0; c < fine.cells(); ++c) {
        const uint32_t leaf = leafOf[size_t(c)];
        const std::optional<Rgb> background = backgroundAt(s, fine, environment, c, leaf);
        cells[size_t(c)] = background ? *background : rest[leaf];
        if (!background && !s.light.anchors.probes.empty() && !s.light.environmentBlack)
            cells[size_t(c)] *= detailOf(s.in.options.probes, s.light.anchors, size_t(c), leaf);
    }
    return cells;
}

/// The environment of the main state is the estimate's, the others follow in their order.
void assembleEnvironments(const SolveRun& s, Estimate& estimate) {
    const DirectionGrid fine{estimate.environmentSide};
    const std::vector<size_t> order = environmentsInOrder(s);
    for (size_t k = 0; k < order.size(); ++k) {
        std::vector<Rgb> cells = environmentCells(s, fine, order[k]);
        if (k == 0) estimate.environment = std::move(cells);
        else estimate.otherEnvironments.push_back({std::move(cells), {}});
    }
    for (size_t state = 0; state < estimate.states.size(); ++state) {
        const auto at = std::find(order.begin(), order.end(), size_t(s.in.samples.environmentOf(uint32_t(state))));
        estimate.states[state].environment = at == order.end() ? -1 : int(at - order.begin());
    }
}

}  // namespace

std::optional<Rgb> backgroundAt(const SolveRun& s, const DirectionGrid& grid, size_t environment, int cell,
                                uint32_t leaf) {
    const DirectionGrid& seen = s.in.samples.backgroundGrid;
    const int step = grid.side / seen.side;
    const size_t at =
        environment * size_t(seen.cells()) + size_t((cell / grid.side / step) * seen.side + cell % grid.side / step);
    if (s.light.environmentBlack || s.in.samples.backgroundPixels[at] < 4 || s.in.samples.backgroundClipped[at] ||
        !s.light.anchors.leaves[leaf].seen())
        return std::nullopt;
    return s.in.samples.background[at];
}

std::vector<size_t> environmentsInOrder(const SolveRun& s) {
    std::vector<size_t> order(1, size_t(std::max(0, s.in.samples.environmentOf(s.mainState()))));
    for (size_t e = 0; e < s.in.samples.environments(); ++e)
        if (e != order[0]) order.push_back(e);
    return order;
}

void turnEnvironment(const SolveRun& s, Estimate& estimate) {
    if (s.in.scene.axes == Mat3(1)) return;
    const DirectionGrid own{estimate.environmentSide, s.in.scene.axes}, world{estimate.environmentSide};
    const auto turn = [&](std::vector<Rgb>& cells, int samples) {
        if (!cells.empty()) cells = turnedCells(cells, own, world, samples);
    };
    const int samples = s.stopped() ? 4 : 8;
    turn(estimate.environment, samples);
    turn(estimate.environmentSigma, 2);
    for (StateLight& other : estimate.otherEnvironments) {
        turn(other.environment, samples);
        turn(other.sigma, 2);
    }
}

Estimate assemble(const SolveRun& s) {
    Estimate estimate;
    estimate.lightSmoothness = s.light.smoothness;
    estimate.albedoSmoothness = s.surfaces.smoothness;
    estimate.palette = s.surfaces.palette.colours;
    estimate.mode = s.in.options.nearField ? "near-field" : "distant-only";
    estimate.lighting = s.light.lighting;
    estimate.emitters = s.emitters.clusters;
    for (const std::string& name : s.in.capture.states) estimate.states.push_back({name, {}});
    for (const View& view : s.in.capture.views)
        if (!estimate.states.empty()) estimate.states[view.state].views.push_back(view.name);
    estimate.nearFieldCorrection = s.light.correction;
    estimate.cancelled = s.stopped();
    estimate.interreflection = s.bounce.joined();
    estimate.bouncedFraction = s.bounce.joined() ? s.bounce.fraction : 0;
    assembleEnvironments(s, estimate);
    Reflectance& r = estimate.reflectance;
    const size_t n = s.in.scene.mesh.vertexCount();
    r.basis.lobes.push_back(s.in.options.basis.lobes[0]);
    r.weight.push_back(s.surfaces.albedo.albedo);
    const auto give = [&](uint32_t component, const Lobe& lobe, const Rgb& weight) {
        // Components of nearly the same roughness share a lobe.
        size_t at = 1;
        const auto alike = [&](const Lobe& l) {
            return l.kind == lobe.kind && l.measured == lobe.measured &&
                   std::abs(std::log(l.alpha / lobe.alpha)) < 0.08f;
        };
        while (at < r.basis.lobes.size() && !alike(r.basis.lobes[at])) ++at;
        if (at == r.basis.lobes.size()) {
            r.basis.lobes.push_back(lobe);
            r.weight.emplace_back(n, Rgb(0));
        }
        for (size_t v = 0; v < n; ++v)
            if (s.in.scene.material[v] == component && s.emitters.clusters.emitterOfVertex[v] < 0)
                r.weight[at][v] += weight;
    };
    for (const ComponentGloss& g : s.gloss.components) {
        if (g.lobe->kind != Lobe::Kind::mixture) give(g.component, *g.lobe, g.weight);
        for (const Lobe& part : g.lobe->parts) give(g.component, part, part.fraction * g.weight);
    }
    // Emitters only emit.
    for (size_t v = 0; v < n; ++v)
        if (s.emitters.clusters.emitterOfVertex[v] >= 0) r.weight[0][v] = Rgb(0);
    r.observed.assign(n, 0);
    for (uint32_t v = 0; v < n; ++v) r.observed[v] = uint8_t(std::min<size_t>(255, s.in.samples.countOf(v)));
    r.confidence = s.surfaces.albedo.confidence;
    return estimate;
}

namespace {

SurfaceLight surfaceLightOf(const SolveRun& s, const Irradiance& irradiance, const Rgb& scale) {
    SurfaceLight light;
    if (!s.hasMatte()) return light;
    const MatteObservations &matte = s.observed.matte, &coated = s.observed.withCoatings;
    light.white.assign(matte.states(), std::vector<Rgb>(s.in.scene.mesh.vertexCount(), Rgb(0)));
    light.coating = light.white;
    light.state = s.mainState();
    for (size_t state = 0; state < matte.states(); ++state)
        for (size_t i = matte.beginOf(state); i < matte.endOf(state); ++i) {
            light.white[state][matte.vertices[i]] = irradiance.value[i] * scale;
            if (!coated.vertices.empty())
                light.coating[state][matte.vertices[i]] = glm::max(coated.radiance[i] - matte.radiance[i], Rgb(0));
        }
    return light;
}

/// On an inexact mesh, and the albedo with it.
void correctLightNearEmitters(SolveRun& s) {
    if (!(s.in.options.meshError > 0) || !s.in.options.nearField || !s.hasMatte() || s.stopped()) return;
    // In the state in which emitters are brightest.
    const uint32_t state = s.mainState();
    const MatteObservations& all = s.observed.matte;
    s.light.correction = correctNearField(
        {s.in.scene, all.inState(state), s.irradiance().inState(all, state), s.light.nearField, s.emitters.clusters,
         s.emitters.inState(s.light.lighting, state).emitterRadiance, s.in.options.meshError},
        s.in.progress);
    if (!s.light.correction.empty()) updateAlbedo(s, s.irradiance());
}

}  // namespace

void showSnapshot(SolveRun& s) {
    if (!s.listener || !s.listener->snapshot || s.stopped()) return;
    const double began = s.in.progress.seconds(), fraction = s.listener->snapshotFraction;
    if (fraction * (began - s.snapshotEnded) < (1 - fraction) * s.snapshotSeconds) return;
    const AlbedoResult albedo = s.surfaces.albedo;
    const bool first = s.gloss.empty();
    if (first) s.gloss.components.swap(s.gloss.early);
    const Irradiance irradiance = s.irradiance();
    updateAlbedo(s, irradiance);
    Estimate estimate = assemble(s);
    applyGauge(s, irradiance, uncertaintyOf(s, irradiance, true), estimate);
    estimate.cancelled = true;
    estimate.timeline = s.timeline;
    estimate.stability = s.stability;
    estimate.identifiability.assign(s.emitters.surfaces.size(), 0.0f);
    estimate.emitterSigma.assign(s.emitters.surfaces.size(), Rgb(0));
    turnEnvironment(s, estimate);
    s.listener->snapshot(std::move(estimate));
    s.surfaces.albedo = albedo;
    if (first) s.gloss.components.swap(s.gloss.early);
    s.snapshotEnded = s.in.progress.seconds();
    s.snapshotSeconds = s.snapshotEnded - began;
}

Estimate finishSolve(SolveRun& s) {
    s.meter.begin(Stage::closing);
    correctLightNearEmitters(s);
    Estimate estimate = assemble(s);
    assessConditioning(s, estimate);
    const Irradiance irradiance = s.irradiance();
    if (s.in.samples.states > 1) statesThatDisagree(s, irradiance);
    if (patchesTakePart(s)) s.patchPart = patchInformation(s);
    const LightUncertainty light = uncertaintyOf(s, irradiance, false);
    const Irradiance unsure = unsureIrradiance(s, irradiance);
    assessUncertainty(s, unsure, light, estimate);
    estimate.heldOut = holdOutViews(s, unsure);
    estimate.probes = probesUnder(s, irradiance);
    applyGauge(s, irradiance, light, estimate);
    estimate.patches = patchesUnder(s, estimate.gauge.scale);
    estimate.surfaceLight = surfaceLightOf(s, irradiance, estimate.gauge.scale);
    if (s.gloss.empty())
        estimate.leftOut.push_back({Omission::glossyLobes, "no surface changes with the view beyond noise"});
    if (s.emitters.clusters.emitters.empty() && s.in.options.nearField)
        estimate.leftOut.push_back({Omission::nearFieldEmitters, "no patch of the scene shines on its own"});
    if (!s.in.options.nearField)
        estimate.leftOut.push_back({Omission::nearFieldEmitters, "the distant-only baseline was asked for"});
    if (s.light.environmentBlack)
        estimate.leftOut.push_back(
            {Omission::distantLight, "it gives less than half a percent of the light on the surfaces"});
    if (!estimate.interreflection) estimate.leftOut.push_back({Omission::interreflection, s.bounce.absentBecause});
    const size_t most = s.in.options.maxLeaves * s.in.samples.environments();
    if (s.light.refined && !s.light.environmentBlack && s.light.lighting.leaves.size() < most &&
        s.light.refinedMisfit > 0)
        estimate.leftOut.push_back(
            {Omission::finerDistantLight,
             "the leaves that are left give too little light, or the last finer ones explained hardly more"});
    if (s.light.lighting.leaves.size() >= most)
        estimate.leftOut.push_back(
            {Omission::finerDistantLight, fmt::format("the limit of {} unknowns was reached", most)});
    s.record("done", 0, 0, s.mismatch(irradiance));
    s.meter.end();
    estimate.timeline = s.timeline;
    estimate.plan = s.measuredPlan();
    turnEnvironment(s, estimate);
    return estimate;
}

}  // namespace relamp
