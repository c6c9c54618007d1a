// Reflectance under the light found, and the last steps of a solve: gauge, environment image, how sure we are.
#include <Eigen/Eigenvalues>

#include "base/log.h"
#include "base/parallel.h"
#include "solve/gloss/matte_under_gloss.h"
#include "solve/light/lighting_step.h"
#include "solve/priors/prior_strength.h"
#include "solve/solve_state.h"

namespace relamp {

void SolveState::solveReflectance() {
    finishVisibility();
    computeLit();
    if (!bounce_.empty() && bouncedFraction_ == 0) bouncedFraction_ = bouncedFractionOf();
    // Glossy components: which lobe, how strong.
    std::vector<ComponentGloss> found;
    std::vector<uint8_t> fitted(scene_.components, 0);
    GlossOptions glossOptions;
    glossOptions.seed = options_.seed;
    glossOptions.rows = rowOptions();
    glossOptions.mostLobes = options_.mostLobes;
    glossOptions.screen = !plan_.choices.lostLobes;
    if (!hasMatte()) glossOptions.maxVertices = 1500;
    const std::vector<size_t> sizes = observationsOfComponents(scene_, matte_);
    for (uint32_t p = 0; p < scene_.components && !stopped(); ++p) {
        if ((!matte_.componentGlossy[p] && !plan_.choices.matteComponents) || sizes[p] < 30) continue;
        const bool metal = hasMatte() && matte_.componentGlossy[p] == 2;
        glossOptions.lambertGain = !metal ? 1.6f : metalsHeard_ ? 3.0f : 1e30f;
        ComponentGloss g;
        try {
            const Progress::Dispensable mayEnd(progress_);
            g = fitGloss(capture_, scene_, samples_, surfaces_, clusters_.emitterOfTriangle, lighting_, basis_, p,
                         glossOptions, progress_);
        } catch (const OutOfTime&) { break; }
        fitted[p] = 1;
        if (!g.lobe) continue;
        logInfo("component {}: {} weight {:.3f} {:.3f} {:.3f}{}, residual {:.2f} of {:.2f}", p, g.lobe->name,
                g.weight.x, g.weight.y, g.weight.z, g.matte ? " over Lambert" : "", g.residual, g.residualMatte);
        found.push_back(std::move(g));
    }
    // A component that the time left unfitted stays as it was.
    const bool hurry = stopped() && !firstGloss_.empty();
    for (ComponentGloss& g : gloss_.empty() ? firstGloss_ : gloss_)
        if (!fitted[g.component]) found.push_back(std::move(g));
    firstGloss_.clear();
    gloss_ = std::move(found);
    for (uint32_t p = 0; p < scene_.components; ++p)
        fitted[p] = fitted[p] && std::none_of(gloss_.begin(), gloss_.end(),
                                              [&](const ComponentGloss& g) { return g.component == p; });
    if (hurry || !stopped()) removeCoatings(hurry, fitted);
    if (!metalsHeard_ && !stopped()) sharpenForMetals();
    metalsHeard_ = true;
    updateAlbedo();
    askAlbedoStrength();
    record("reflectance", int(timeline_.size()), 0, pairMismatch());
}

void SolveState::removeCoatings(bool hurry, const std::vector<uint8_t>& matteAfterAll) {
    if (!matteSeen_.vertices.empty()) matte_ = matteSeen_;
    readAsMatte(matteAfterAll);
    for (const ComponentGloss& g : gloss_) {
        if (!g.lobe || !g.matte || (stopped() && !hurry)) continue;
        if (matteSeen_.vertices.empty()) matteSeen_ = matte_;
        MatteUnderGlossOptions options;
        options.rows = rowOptions();
        // Every look has a row here: fewer directions will do, because looks are averaged.
        options.rows.lobeSamples = hurry ? 16 : 48;
        options.rows.cosineSamples = hurry ? 8 : 24;
        options.rows.emitterSamples = hurry ? 8 : 16;
        matteUnderGloss(capture_, scene_, samples_, surfaces_, clusters_.emitterOfTriangle, lighting_, g, options,
                        matte_, progress_);
    }
}

void SolveState::readAsMatte(const std::vector<uint8_t>& components) {
    std::vector<uint8_t> glossy = matte_.componentGlossy, skip(scene_.mesh.vertexCount(), 1);
    bool any = false;
    for (size_t p = 0; p < glossy.size(); ++p)
        if (components[p] && glossy[p]) glossy[p] = 0, any = true;
    if (!any) return;
    if (matteSeen_.vertices.empty()) matteSeen_ = matte_;
    for (uint32_t v : matte_.vertices) skip[v] = !components[scene_.component[v]];
    const MatteObservations median = matteObservations(scene_, samples_, skip, &glossy);
    size_t i = 0;
    for (size_t k = 0; k < median.vertices.size(); ++k) {
        while (matte_.vertices[i] != median.vertices[k]) ++i;
        matte_.radiance[i] = median.radiance[k];
        matte_.sigma[i] = median.sigma[k];
    }
}

void SolveState::takeStrengths(const PriorStrength& light, const PriorStrength& albedo) {
    lightPrior_.smoothness = LightPriorOptions{}.smoothness * light.factor;
    albedoPrior_.step = options_.prior.step / std::sqrt(albedo.factor);
    lightSmoothness_ = light;
    albedoSmoothness_ = albedo;
}

void SolveState::askLightStrength() {
    if (!options_.askForStrength || options_.lightSmoothness > 0 || !hasMatte() || !options_.nearField ||
        environmentBlack_ || stopped())
        return;
    constexpr size_t maxRows = 6000;
    std::vector<Vec3> positions(matte_.vertices.size());
    for (size_t i = 0; i < positions.size(); ++i)
        positions[i] = scene_.mesh.positions[matte_.vertices[i]] * scene_.axes;
    AlbedoFreeOptions o;
    o.light = lightPrior_;
    o.emptyColumns = plan_.choices.emptyColumns;
    o.bounce = bounce_.empty() ? nullptr : &bounce_;
    takeStrengths(testLightStrength(influence_, matte_, pairs_, positions, anchors_, o, lighting_, maxRows, progress_),
                  albedoSmoothness_);
    for (const PriorStrength::Trial& t : lightSmoothness_.trials)
        logInfo("light {:.2g} times as smooth: misfit of pairs left out {:.4f} +- {:.4f}", t.factor, t.misfit, t.error);
}

void SolveState::askAlbedoStrength() {
    if (!options_.askForStrength || options_.albedoSmoothness > 0 || !albedoSmoothness_.trials.empty() ||
        matte_.vertices.empty() || stopped())
        return;
    takeStrengths(lightSmoothness_, testAlbedoStrength(scene_, samples_, matte_, lit_, litSigma_, albedoPrior_,
                                                       albedo_.albedo, options_.seed, progress_));
    for (const PriorStrength::Trial& t : albedoSmoothness_.trials)
        logInfo("surfaces {:.2g} times as smooth: misfit of looks left out {:.4f} +- {:.4f}", t.factor, t.misfit,
                t.error);
    if (albedoSmoothness_.factor != 1) updateAlbedo();
}

void SolveState::updateAlbedo() {
    albedo_ = solveAlbedo(scene_, matte_, lit_, litSigma_, albedoPrior_, progress_);
    if (options_.palette > 0)
        albedo_ = solveAlbedoWithPalette(scene_, matte_, lit_, litSigma_, albedoPrior_, options_.palette,
                                         std::move(albedo_), palette_, progress_);
    withoutMetals(albedo_.albedo);
}

void SolveState::withoutMetals(std::vector<Rgb>& albedo) const {
    for (const ComponentGloss& g : gloss_)
        if (!g.matte)
            for (size_t v = 0; v < scene_.mesh.vertexCount(); ++v)
                if (scene_.component[v] == g.component) albedo[v] = Rgb(0);
}

void SolveState::startFromConstantAlbedo() {
    albedo_.albedo.assign(scene_.mesh.vertexCount(), Rgb(0.5f));
    computeLit();
    for (int round = 0; round < 3; ++round) alternate();
}

void SolveState::alternate() {
    if (environmentBlack_) return;
    // The step changes one channel after the other: nothing is taken over before all are there.
    Lighting improved = lighting_;
    const LightPrior prior(lighting_.leaves, anchors_, lightPrior_, &influence_);
    const LightingStepReport step =
        lightingStep(influence_, matte_, albedo_.albedo, litSigma_, prior, bounce_, improved, progress_);
    lighting_ = std::move(improved);
    stability_.kktResidual = step.kktResidual;
    computeLit();
    updateAlbedo();
    record("light and reflectance in turn", int(timeline_.size()), step.after, pairMismatch());
    logInfo("light and reflectance in turn: objective {:.4g} -> {:.4g}, rmse {:.3g}", step.before, step.after,
            step.rmse);
}

double SolveState::pairMismatch() const {
    double sum = 0, counted = 0;
    for (const AlbedoPair& p : pairs_)
        for (int c = 0; c < 3; ++c) {
            const double a = double(matte_.radiance[p.a][c]) * double(lit_[p.b][c]),
                         b = double(matte_.radiance[p.b][c]) * double(lit_[p.a][c]);
            sum += robustStep(2 * (a - b) / std::max(a + b, 1e-30));
            ++counted;
        }
    return std::sqrt(sum / std::max(1.0, counted));
}

void SolveState::assembleEnvironment(Estimate& estimate) const {
    const DirectionGrid fine{estimate.environmentSide};
    estimate.environment.resize(size_t(fine.cells()));
    const DirectionGrid& seen = samples_.backgroundGrid;
    const int step = estimate.environmentSide / seen.side;
    const std::vector<uint32_t> leafOf = lighting_.leaves.leafOfCells(fine);
    for (int c = 0; c < fine.cells(); ++c) {
        const uint32_t leaf = leafOf[size_t(c)];
        const int coarse = (c / fine.side / step) * seen.side + (c % fine.side) / step;
        const bool direct = !environmentBlack_ && samples_.backgroundPixels[size_t(coarse)] >= 4 &&
                            !samples_.backgroundClipped[size_t(coarse)];
        estimate.environment[size_t(c)] = direct && anchors_.leaves[leaf].coverage > 0.05f
                                              ? samples_.background[size_t(coarse)]
                                              : lighting_.leafRadiance[leaf];
    }
}

void SolveState::turnEnvironment(Estimate& estimate) const {
    if (scene_.axes == Mat3(1)) return;
    const DirectionGrid own{estimate.environmentSide, scene_.axes}, world{estimate.environmentSide};
    estimate.environment = turnedCells(estimate.environment, own, world, stopped() ? 4 : 8);
    if (!estimate.environmentSigma.empty())
        estimate.environmentSigma = turnedCells(estimate.environmentSigma, own, world, 2);
}

void SolveState::assess(Estimate& estimate) {
    // Gram of the lighting problem under the albedo found, on a spread of vertices.
    const size_t n = influence_.columns, leaves = lighting_.leaves.size();
    const InfluenceMatrix& rows = influence_;
    Eigen::MatrixXd gram = weightedGram(
        rows,
        [&](size_t i, float* out) {
            const Rgb albedo = albedo_.albedo[matte_.vertices[i]], sigma = matte_.sigma[i] + 0.01f * matte_.radiance[i];
            const float w = scene_.rank[matte_.vertices[i]] % 4 == 0
                                ? albedo.y * albedo.y / std::max(sigma.y * sigma.y, 1e-20f)
                                : 0.0f;
            for (size_t k = 0; k < n; ++k) out[k] = w * rows.row(i)[k];
        },
        progress_);
    if (hasGloss()) {
        // Glossy looks tell directions apart that matte ones cannot.
        const ViewRows glossy = viewRows(progress_);
        gram += weightedGram(
            glossy.influence[1],
            [&](size_t i, float* out) {
                const float w = 1 / std::max(glossy.sigma[i] * glossy.sigma[i], 1e-20f);
                for (size_t k = 0; k < n; ++k) out[k] = w * glossy.influence[1].row(i)[k];
            },
            progress_);
    }
    Eigen::VectorXd scale(gram.rows());
    for (Eigen::Index i = 0; i < gram.rows(); ++i) scale(i) = gram(i, i) > 0 ? 1 / std::sqrt(gram(i, i)) : 0;
    const Eigen::MatrixXd scaled = scale.asDiagonal() * gram * scale.asDiagonal();
    Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(scaled, Eigen::EigenvaluesOnly);
    estimate.stability = stability_;
    estimate.stability.unknowns = int(n);
    if (stability_.kktResidual > 1e-6)
        estimate.stability.reason =
            fmt::format("a lighting program stopped at a relative KKT residual of {:.1e}", stability_.kktResidual);
    const double largest = std::max(eigen.eigenvalues().maxCoeff(), 1e-300);
    double smallest = largest;
    for (Eigen::Index i = 0; i < gram.rows(); ++i) {
        const double value = eigen.eigenvalues()(i) / largest;
        if (value > 1e-6) ++estimate.stability.effectiveRank;
        if (value > 1e-14) smallest = std::min(smallest, value * largest);
    }
    estimate.stability.conditionNumber = largest / smallest;
    const Eigen::Index step = std::max<Eigen::Index>(1, (gram.rows() + 255) / 256);
    for (Eigen::Index i = gram.rows() - 1; i >= 0; i -= step)
        estimate.stability.spectrum.push_back(float(std::max(0.0, eigen.eigenvalues()(i) / largest)));
    const Eigen::Index m = Eigen::Index(leaves);
    Eigen::MatrixXd distant = scaled.topLeftCorner(m, m);
    distant.diagonal().array() += 1e-6;
    const Eigen::LLT<Eigen::MatrixXd> factor(distant);
    for (size_t e = 0; e < surfaces_.size(); ++e) {
        const Eigen::VectorXd column = scaled.block(0, m + Eigen::Index(e), m, 1);
        const double self = scaled(m + Eigen::Index(e), m + Eigen::Index(e));
        const double imitated =
            self > 0 && factor.info() == Eigen::Success ? column.dot(factor.solve(column)) / self : 1;
        estimate.identifiability.push_back(float(std::sqrt(std::clamp(1 - imitated, 0.0, 1.0))));
        estimate.emitterSigma.push_back(lighting_.emitterRadiance[e] * (clusters_.emitters[e].unobserved ? 1.0f
                                                                        : anchors_.emitterClipped[e]
                                                                            ? 0.5f
                                                                            : anchors_.emitterSigma[e]));
    }
}

Estimate SolveState::assemble() const {
    Estimate estimate;
    estimate.lightSmoothness = lightSmoothness_;
    estimate.albedoSmoothness = albedoSmoothness_;
    estimate.palette = palette_.colours;
    estimate.mode = options_.nearField ? "near-field" : "distant-only";
    estimate.lighting = lighting_;
    estimate.emitters = clusters_;
    estimate.cancelled = stopped();
    estimate.interreflection = !bounce_.empty();
    estimate.bouncedFraction = bounce_.empty() ? 0 : bouncedFraction_;
    assembleEnvironment(estimate);
    Reflectance& r = estimate.reflectance;
    const size_t n = scene_.mesh.vertexCount();
    r.basis.lobes.push_back(basis_.lobes[0]);
    r.weight.push_back(albedo_.albedo);
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
            if (scene_.component[v] == component && clusters_.emitterOfVertex[v] < 0) r.weight[at][v] += weight;
    };
    for (const ComponentGloss& g : gloss_) {
        if (g.lobe->kind != Lobe::Kind::mixture) give(g.component, *g.lobe, g.weight);
        for (const Lobe& part : g.lobe->parts) give(g.component, part, part.fraction * g.weight);
    }
    // Emitters only emit.
    for (size_t v = 0; v < n; ++v)
        if (clusters_.emitterOfVertex[v] >= 0) r.weight[0][v] = Rgb(0);
    r.observed.assign(n, 0);
    for (uint32_t v = 0; v < n; ++v) r.observed[v] = uint8_t(std::min<size_t>(255, samples_.countOf(v)));
    r.confidence = albedo_.confidence;
    return estimate;
}

void SolveState::showSnapshot() {
    if (!listener_ || !listener_->snapshot || stopped()) return;
    const AlbedoResult albedo = albedo_;
    const std::vector<Rgb> lit = lit_, litSigma = litSigma_;
    const bool first = gloss_.empty();
    if (first) gloss_.swap(firstGloss_);
    computeLit();
    updateAlbedo();
    Estimate estimate = assemble();
    applyGauge(uncertainty(true), estimate);
    estimate.cancelled = true;
    estimate.timeline = timeline_;
    estimate.stability = stability_;
    estimate.identifiability.assign(surfaces_.size(), 0.0f);
    estimate.emitterSigma.assign(surfaces_.size(), Rgb(0));
    turnEnvironment(estimate);
    listener_->snapshot(std::move(estimate));
    albedo_ = albedo;
    lit_ = lit;
    litSigma_ = litSigma;
    if (first) gloss_.swap(firstGloss_);
}

std::vector<HeldOutAlbedo> SolveState::holdOutViews() {
    std::vector<HeldOutAlbedo> held;
    const size_t views = capture_.views.size();
    if (views < 4 || !hasMatte() || stopped()) return held;
    std::vector<uint8_t> skip(scene_.mesh.vertexCount(), 0);
    for (size_t v = 0; v < skip.size(); ++v) skip[v] = clusters_.emitterOfVertex[v] >= 0;
    std::vector<uint32_t> at(scene_.mesh.vertexCount(), 0);
    for (uint32_t i = 0; i < matte_.vertices.size(); ++i) at[matte_.vertices[i]] = i;
    AlbedoPrior prior = albedoPrior_;
    prior.iterations = 2;
    for (const size_t view : {views / 3, 2 * views / 3}) {
        RadianceSamples others;
        others.relativeNoise = samples_.relativeNoise;
        others.noiseFloor = samples_.noiseFloor;
        others.start.assign(1, 0);
        for (uint32_t v = 0; v < skip.size(); ++v) {
            for (uint32_t s = samples_.start[v]; s < samples_.start[v + 1]; ++s)
                if (samples_.samples[s].view != view) others.samples.push_back(samples_.samples[s]);
            others.start.push_back(uint32_t(others.samples.size()));
        }
        MatteObservations matte = matteObservations(scene_, others, skip, &matte_.componentGlossy);
        if (matte.vertices.empty()) continue;
        std::vector<Rgb> lit, litSigma;
        for (size_t i = 0; i < matte.vertices.size(); ++i) {
            const uint32_t k = at[matte.vertices[i]];
            lit.push_back(lit_[k]);
            litSigma.push_back(litSigma_[k]);
            // What coatings mirror, as it was taken off the whole.
            if (!matteSeen_.vertices.empty())
                matte.radiance[i] *= matte_.radiance[k] / glm::max(matteSeen_.radiance[k], Rgb(1e-20f));
        }
        AlbedoResult albedo = solveAlbedo(scene_, matte, lit, litSigma, prior, progress_);
        withoutMetals(albedo.albedo);
        for (size_t v = 0; v < skip.size(); ++v)
            if (skip[v]) albedo.albedo[v] = Rgb(0);
        held.push_back({view, std::move(albedo.albedo)});
    }
    return held;
}

Estimate SolveState::finish() {
    meter_.begin(Stage::closing);
    Estimate estimate = assemble();
    assess(estimate);
    computeLit();
    const LightUncertainty light = uncertainty(false);
    assessUncertainty(light, estimate);
    estimate.heldOut = holdOutViews();
    applyGauge(light, estimate);
    if (gloss_.empty()) estimate.leftOut.push_back({Omission::glossyLobes, "no surface changes with the view beyond noise"});
    if (clusters_.emitters.empty() && options_.nearField)
        estimate.leftOut.push_back({Omission::nearFieldEmitters, "no patch of the scene shines on its own"});
    if (!options_.nearField)
        estimate.leftOut.push_back({Omission::nearFieldEmitters, "the distant-only baseline was asked for"});
    if (environmentBlack_)
        estimate.leftOut.push_back({Omission::distantLight, "it gives less than half a percent of the light on the surfaces"});
    if (!estimate.interreflection) estimate.leftOut.push_back({Omission::interreflection, noBounceBecause_});
    if (refined_ && !environmentBlack_ && lighting_.leaves.size() < options_.maxLeaves && refinedMisfit_ > 0)
        estimate.leftOut.push_back(
            {Omission::finerDistantLight,
             "the leaves that are left give too little light, or the last finer ones explained hardly more"});
    if (lighting_.leaves.size() >= options_.maxLeaves)
        estimate.leftOut.push_back(
            {Omission::finerDistantLight, fmt::format("the limit of {} unknowns was reached", options_.maxLeaves)});
    record("done", 0, 0, pairMismatch());
    meter_.end();
    estimate.timeline = timeline_;
    estimate.plan = measuredPlan();
    turnEnvironment(estimate);
    return estimate;
}

}  // namespace relamp
