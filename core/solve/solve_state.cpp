#include "solve/solve_state.h"

#include "base/log.h"
#include "base/parallel.h"
#include "base/random.h"
#include "solve/gloss/one_lobe.h"

namespace relamp {

SolveState::SolveState(const Capture& capture, const Scene& scene, const RadianceSamples& samples,
                       const SolveOptions& options, Progress& progress, const SolveListener* listener)
    : capture_(capture),
      scene_(scene),
      samples_(samples),
      options_(options),
      progress_(progress),
      listener_(listener),
      meter_(progress),
      plan_(options.plan) {
    const auto strength = [](float told) { return told > 0 ? PriorStrength{told, "artist"} : PriorStrength{}; };
    takeStrengths(strength(options.lightSmoothness), strength(options.albedoSmoothness));
}

void SolveState::record(const std::string& stage, int iteration, double objective, double rmse) {
    timeline_.push_back({progress_.seconds(), stage, iteration, objective, rmse});
    if (listener_ && listener_->entry) listener_->entry(timeline_.back());
    if (!stepMayBeCut_ || !listener_ || !listener_->checkpoint ||
        progress_.seconds() - lastCheckpoint_ < listener_->checkpointSeconds)
        return;
    lastCheckpoint_ = progress_.seconds();
    listener_->checkpoint(checkpoint(step_, false));
}

void SolveState::takeClusters(const EmitterClusters& clusters) {
    clusters_ = clusters;
    if (!options_.nearField) {
        clusters_.emitters.clear();
        clusters_.candidates.clear();
    }
    // Candidates take part as emitters until the light fit has judged them.
    struct Entry {
        EmitterCluster cluster;
        bool suspect;
    };
    std::vector<Entry> all;
    for (EmitterCluster& c : clusters_.emitters) all.push_back({std::move(c), false});
    for (EmitterCluster& c : clusters_.candidates) all.push_back({std::move(c), true});
    std::stable_sort(all.begin(), all.end(),
                     [](const Entry& a, const Entry& b) { return emitterPower(a.cluster) > emitterPower(b.cluster); });
    clusters_.emitters.clear();
    clusters_.candidates.clear();
    suspect_.clear();
    for (Entry& e : all) {
        clusters_.emitters.push_back(std::move(e.cluster));
        suspect_.push_back(e.suspect);
    }
    indexEmitters(scene_, clusters_);
}

void SolveState::rebuildNearField() {
    surfaces_.clear();
    for (const EmitterCluster& e : clusters_.emitters) surfaces_.push_back(orderedEmitterSurface(scene_, e));
    // Transport of what no photograph shows is computed when it is asked for.
    known_ = scene_.referenced;
    if (!plan_.choices.unobservedVertices)
        for (uint32_t v = 0; v < known_.size(); ++v)
            known_[v] = samples_.countOf(v) > 0 || clusters_.emitterOfVertex[v] >= 0;
    NearFieldOptions nearOptions;
    nearOptions.seed = options_.seed;
    nearOptions.only = &known_;
    nearField_ = computeNearField(scene_, clusters_, nearOptions, progress_);
    std::vector<uint8_t> skip(scene_.mesh.vertexCount(), 0);
    for (size_t v = 0; v < skip.size(); ++v) skip[v] = clusters_.emitterOfVertex[v] >= 0;
    const RatioObservations* observed = plan_.observed.get();
    RatioObservations anew;
    if (!observed || observed->skip != skip || observed->seed != options_.seed || observed->noMetals != noMetals_) {
        anew = ratioObservations(scene_, samples_, std::move(skip), options_.seed, noMetals_);
        observed = &anew;
    }
    matte_ = observed->matte;
    pairs_ = observed->pairs;
    plan_.observed.reset();
    std::vector<float> brightness;
    for (const Rgb& y : matte_.radiance) brightness.push_back(maxChannel(y));
    std::sort(brightness.begin(), brightness.end());
    lightPrior_.darkness = brightness.empty() ? 0.0f : 1e-3f * brightness[brightness.size() * 9 / 10];
    size_t usable = 0;
    for (uint32_t v : matte_.vertices) usable += matte_.componentGlossy[scene_.component[v]] < 2;
    matteFraction_ = matte_.vertices.empty() ? 0 : double(usable) / double(matte_.vertices.size());
}

void SolveState::prepare(const EmitterClusters& clusters) {
    if (samples_.samples.empty())
        throw Error(
            "no vertex of the mesh is seen by any photograph: check the cameras' poses and the mesh's scale with "
            "`relamp check`");
    meter_.begin(Stage::ratios);
    takeClusters(clusters);
    rebuildNearField();
    if (matte_.vertices.empty())
        throw Error(
            "no vertex has a usable observation: every pixel on the mesh is clipped, or all of the mesh was taken for "
            "lights; `relamp check` tells which");
    environmentBlack_ = !plan_.choices.distantLight && !surfaces_.empty();
    constexpr auto coarsest = [](const LightLeaves& leaves) {
        int level = LightLeaves::maxLevel;
        for (size_t i = 0; i < leaves.size(); ++i) level = std::min(level, int(leaves[i].level));
        return level;
    };
    startsFromPlan_ = plan_.light && !environmentBlack_ && options_.nearField && hasMatte() &&
                      coarsest(plan_.light->leaves) == firstLevel() && firstLevel() < options_.startLevel;
    lighting_.leaves = startsFromPlan_ ? plan_.light->leaves : LightLeaves::uniform(firstLevel(), scene_.axes);
    rebuildRows();
    guessLight();
    if (startsFromPlan_) lighting_.leafRadiance = plan_.light->leafRadiance;
    plan_.light.reset();
}

int SolveState::visibilityStepFor(int level) const {
    const bool coarseFirst = firstLevel() < options_.startLevel && level <= options_.startLevel;
    return coarseFirst ? std::max(1, options_.visibilitySide >> (level + 1)) : 1;
}

void SolveState::learnVisibility(int step) {
    if (!visibility_.bits.empty()) {
        refineVisibility(scene_, known_, step, plan_.choices.agreeingRays, visibility_, progress_);
        traceFinerLeaves(lighting_.leaves, known_);
        return;
    }
    VisibilityOptions visibilityOptions;
    visibilityOptions.gridSide = options_.visibilitySide;
    visibilityOptions.axes = scene_.axes;
    visibilityOptions.only = &known_;
    visibilityOptions.step = step;
    visibilityOptions.agreeing = plan_.choices.agreeingRays;
    visibility_ = computeVisibility(scene_, visibilityOptions, progress_);
    traceFinerLeaves(lighting_.leaves, known_);
}

void SolveState::traceFinerLeaves(const LightLeaves& leaves, const std::vector<uint8_t>& only) {
    std::vector<FinerDirections> blocks;
    for (size_t i = 0; i < leaves.size(); ++i) {
        const int side = visibility_.grid.side >> leaves[i].level, step = std::max(1, side / 2);
        if (side >= 1 && step < visibility_.step)
            blocks.push_back({leaves[i].x * side, leaves[i].y * side, side, step});
    }
    if (!blocks.empty()) traceFiner(scene_, only, blocks, visibility_, progress_);
}

void SolveState::finishVisibility() {
    if (environmentBlack_ || visibility_.step == 1 || stopped()) return;
    const std::optional<Stage> stage = meter_.current();
    meter_.begin(Stage::visibility);
    learnVisibility(1);
    meter_.begin(stage);
    influence_ = rowsOf(matte_.vertices);
    computeLit();
}

int SolveState::firstLevel() const {
    if (environmentBlack_) return 0;
    return options_.nearField && hasMatte() ? std::max(2, options_.startLevel - 1) : options_.startLevel;
}

void SolveState::rebuildRows() {
    if (!environmentBlack_ && visibility_.bits.empty()) {
        meter_.begin(Stage::visibility);
        learnVisibility(visibilityStepFor(firstLevel()));
    }
    meter_.begin(Stage::rows);
    anchorLight();
    shapeLeaves();
    influence_ = rowsOf(matte_.vertices);
}

void SolveState::anchorLight() {
    anchors_ = lightAnchors(samples_, clusters_, lighting_.leaves);
    if (backgroundRefuted_) anchors_.leaves.assign(anchors_.leaves.size(), LeafAnchor{});
}

bool SolveState::refuteBackground() {
    if (backgroundRefuted_ || environmentBlack_ || matte_.vertices.empty() || !bounce_.empty() ||
        !tiesScale(anchors_, lightPrior_.darkness))
        return false;
    LightAnchors others = anchors_;
    others.leaves.clear();
    if (tiesScale(others, lightPrior_.darkness)) return false;
    std::vector<float> albedo;
    for (size_t i = 0; i < influence_.rows; ++i)
        if (const float lit = luminance(lightOfRow(influence_.row(i), lighting_)); lit > 0)
            albedo.push_back(luminance(matte_.radiance[i]) / lit);
    if (albedo.empty()) return false;
    std::nth_element(albedo.begin(), albedo.begin() + ptrdiff_t(albedo.size() / 2), albedo.end());
    const float middle = albedo[albedo.size() / 2];
    if (middle > 0.04f && middle < 1.3f) return false;
    logInfo("the background seen would need surfaces of albedo {:.2g}: it is not what lights the scene", middle);
    backgroundRefuted_ = true;
    anchorLight();
    shapeLeaves();
    for (Rgb& l : lighting_.leafRadiance) l *= middle / 0.5f;
    return true;
}

InfluenceMatrix SolveState::rowsOf(const std::vector<uint32_t>& vertices) {
    std::vector<uint8_t> unknown(known_.size(), 0);
    bool any = false;
    for (uint32_t v : vertices) any |= unknown[v] = !known_[v];
    if (any) learnTransport(unknown);
    if (!environmentBlack_ || !visibility_.bits.empty())
        return lambertInfluence(scene_, visibility_, nearField_, lighting_.leaves, vertices, progress_);
    // Nothing comes from afar: columns of zeros.
    InfluenceMatrix matrix;
    matrix.rows = vertices.size();
    matrix.columns = lighting_.leaves.size() + nearField_.emitters;
    matrix.values.assign(matrix.rows * matrix.columns, 0.0f);
    for (size_t r = 0; r < matrix.rows; ++r)
        for (size_t e = 0; e < nearField_.emitters; ++e)
            matrix.row(r)[lighting_.leaves.size() + e] = nearField_.at(vertices[r], e);
    return matrix;
}

void SolveState::learnTransport(const std::vector<uint8_t>& vertices) {
    if (!visibility_.bits.empty()) {
        addVisibility(scene_, vertices, visibility_, progress_);
        traceFinerLeaves(lighting_.leaves, vertices);
    }
    NearFieldOptions nearOptions;
    nearOptions.seed = options_.seed;
    nearOptions.only = &vertices;
    addNearField(scene_, clusters_, nearOptions, nearField_, progress_);
    for (size_t v = 0; v < known_.size(); ++v) known_[v] |= vertices[v];
}

void SolveState::guessLight() {
    lighting_.emitterRadiance = firstRadiance(clusters_);
    lighting_.leafRadiance.assign(lighting_.leaves.size(), Rgb(0));
    if (environmentBlack_) return;
    // A constant environment that would show the median radiance on an albedo of 0.3.
    std::vector<float> values;
    for (int c = 0; c < 3; ++c) {
        values.clear();
        for (const Rgb& y : matte_.radiance) values.push_back(y[c]);
        std::nth_element(values.begin(), values.begin() + ptrdiff_t(values.size() / 2), values.end());
        const float start = std::max(values[values.size() / 2] / 0.3f, 1e-9f);
        for (Rgb& l : lighting_.leafRadiance) l[c] = start;
    }
}

AlbedoFreeReport SolveState::runAlbedoFree(const std::string& stage, int iterations, const ViewRows* rows,
                                           const RatioProblem* problem, std::optional<ChromaFraction> chroma,
                                           FitEnd end) {
    AlbedoFreeOptions o;
    o.chroma = chroma;
    o.iterations = iterations;
    // Light is soft when metals first join: their looks are far off and would be taken for outliers.
    const bool firstOfMetals = problem && !metalsJoined_;
    metalsJoined_ |= problem != nullptr;
    const bool guessed = timeline_.empty() && !startsFromPlan_;
    o.anneal = guessed || firstOfMetals;
    o.leastIterations = guessed ? 4 : timeline_.empty() ? 1 : 0;
    o.light = lightPrior_;
    o.emptyColumns = plan_.choices.emptyColumns;
    // Light that goes on to be made finer or tried out need not be fitted to the end.
    o.leastGain =
        end != FitEnd::last && !rows && !plan_.choices.lastDigits ? (end == FitEnd::coarse ? 1e-2f : 3e-4f) : 0.0f;
    o.closing = end != FitEnd::coarse;
    if (problem) {
        o.fold = problem->fold;
        o.foldedRows = problem->foldedRows;
    }
    const std::vector<Rgb>& bounce = problem ? problem->bounce : bounce_;
    o.bounce = bounce.empty() ? nullptr : &bounce;
    LightInformation earlier;
    std::swap(earlier, information_);
    if (!progress_.hasBudget()) earlier = {};  // as large as what takes its place
    AlbedoFreeReport report = solveAlbedoFree(
        influence_, problem ? problem->observations : matte_, problem ? problem->pairs : pairs_, anchors_, rows, o,
        lighting_, progress_, [&](int i, double objective, double rmse) { record(stage, i, objective, rmse); });
    stability_.kktResidual = report.kktResidual;
    // Cut before its first step, a fit says nothing of what fixes the light.
    const bool same = earlier.all.size() == report.information.all.size();
    information_ = same && report.iterations == 0 ? std::move(earlier) : std::move(report.information);
    lightUnfinished_ = report.endedEarly;
    if (refuteBackground()) return runAlbedoFree(stage, std::max(iterations, 4), rows, problem, chroma, end);
    logInfo(
        "{}: {} iterations, objective {:.4g}, {} unknowns, chroma {:.3f} of the noise and {:.3f} of the rest, {:.1f} s",
        stage, report.iterations, report.objective, lighting_.leaves.size() + surfaces_.size(), report.chroma.noise,
        report.chroma.model, progress_.seconds());
    return report;
}

bool SolveState::startFromConstantReflectance() {
    // The component with the most observations stands for the scene.
    std::vector<size_t> observationsOf(scene_.components, 0);
    for (uint32_t v : matte_.vertices) observationsOf[scene_.component[v]] += samples_.countOf(v);
    const uint32_t component =
        uint32_t(std::max_element(observationsOf.begin(), observationsOf.end()) - observationsOf.begin());
    GlossOptions options;
    options.seed = options_.seed;
    options.maxVertices = 1000;
    options.rows = rowOptions();
    const std::vector<GlossyObservation> observations =
        glossyObservations(capture_, scene_, samples_, component, options);
    if (observations.size() < 40) {
        runAlbedoFree("light from ratios", options_.startIterations, nullptr);
        return true;
    }
    double best = 1e300;
    Lighting bestLighting = lighting_;
    ComponentGloss chosen;
    chosen.component = component;
    chosen.matte = false;
    chosen.observations = observations;
    const auto attempt = [&](const Lobe& lobe) {
        const InfluenceMatrix rows = glossyRows(scene_, surfaces_, clusters_.emitterOfTriangle, lighting_.leaves, lobe,
                                                observations, options.rows, progress_);
        const OneLobeFit fit = fitOneLobe(rows, observations, anchors_, lighting_, progress_);
        stability_.kktResidual = std::max(stability_.kktResidual, fit.kktResidual);
        if (!(fit.residual < best)) return false;
        best = fit.residual;
        bestLighting = fit.lighting;
        chosen.lobe = lobe;
        chosen.weight = fit.weight;
        chosen.residual = float(fit.residual);
        return true;
    };
    for (size_t k = 1; k < basis_.lobes.size(); ++k)
        if ((basis_.lobes[k].kind == Lobe::Kind::ggx || basis_.lobes[k].kind == Lobe::Kind::measured) &&
            !(chosen.lobe && stopped()))
            attempt(basis_.lobes[k]);
    if (!chosen.lobe) {
        runAlbedoFree("light from ratios", options_.startIterations, nullptr);
        return true;
    }
    const InfluenceMatrix chosenRows = glossyRows(scene_, surfaces_, clusters_.emitterOfTriangle, lighting_.leaves,
                                                  *chosen.lobe, observations, options.rows, progress_);
    const MetalEvidence evidence = metalEvidence(chosenRows, bestLighting, observations);
    logInfo("one lobe explains the looks within {:.2f}, surfaces that look alike from everywhere within {:.2f}",
            evidence.asMetal, evidence.alikeFromEverywhere);
    if (evidence.asMetal >= evidence.alikeFromEverywhere) {
        noMetals_ = true;
        return false;
    }
    lighting_ = bestLighting;
    gloss_.assign(1, chosen);
    logInfo("one lobe, {}: residual {:.2f}, weight {:.3f} {:.3f} {:.3f}", chosen.lobe->name, best, chosen.weight.x,
            chosen.weight.y, chosen.weight.z);
    // A mirror-like surface shows the environment sharper than matte ones do: halve the leaves everywhere.
    std::vector<uint32_t> all(lighting_.leaves.size());
    for (uint32_t i = 0; i < all.size(); ++i) all[i] = i;
    splitLeaves(all);
    improveLight(options_.refineIterations);
    return true;
}

void SolveState::shapeLeaves() {
    // Inside a leaf that the background covers, its brightness is known in detail.
    const DirectionGrid& grid = samples_.backgroundGrid;
    leafShape_.assign(size_t(grid.cells()), 1.0f);
    const std::vector<uint32_t> leafOf = lighting_.leaves.leafOfCells(grid);
    for (int cell = 0; cell < grid.cells(); ++cell) {
        const uint32_t leaf = leafOf[size_t(cell)];
        const LeafAnchor& a = anchors_.leaves[leaf];
        if (a.coverage < 0.95f || a.clipped || samples_.backgroundPixels[size_t(cell)] < 4 ||
            !(luminance(a.radiance) > 0))
            continue;
        leafShape_[size_t(cell)] = luminance(samples_.background[size_t(cell)]) / luminance(a.radiance);
    }
}

LobeRowOptions SolveState::rowOptions() const {
    LobeRowOptions options;
    options.seed = options_.seed;
    options.shape = leafShape_.empty() ? nullptr : &leafShape_;
    options.shapeGrid = samples_.backgroundGrid;
    options.outgoing = outgoing_.empty() ? nullptr : &outgoing_;
    return options;
}

void SolveState::finishLight() {
    if (!lightUnfinished_ || stopped() || environmentBlack_) return;
    runAlbedoFree("light from ratios", options_.refineIterations, nullptr, nullptr, {}, FitEnd::last);
}

void SolveState::improveLight(int iterations) {
    if (stopped() || environmentBlack_) return;
    if (gloss_.empty()) {
        runAlbedoFree("light from ratios", iterations, nullptr);
        return;
    }
    if (!hasMatte() && gloss_.size() == 1 && !gloss_[0].matte) {
        ComponentGloss& g = gloss_[0];
        Lighting bestLighting = lighting_;
        double best = 1e300;
        const Lobe start = *g.lobe;
        // The roughness moves with the light: a blurred environment looks like a rough surface.
        for (float factor : {1.0f, 1.08f, 1 / 1.08f}) {
            if (stopped() && best < 1e300) break;
            const Lobe lobe = withRoughness(start, factor);
            if (factor != 1 && lobe.alpha == start.alpha) continue;
            const InfluenceMatrix rows = glossyRows(scene_, surfaces_, clusters_.emitterOfTriangle, lighting_.leaves,
                                                    lobe, g.observations, rowOptions(), progress_);
            const OneLobeFit fit = fitOneLobe(rows, g.observations, anchors_, lighting_, progress_);
            stability_.kktResidual = std::max(stability_.kktResidual, fit.kktResidual);
            if (!(fit.residual < best)) continue;
            best = fit.residual;
            bestLighting = fit.lighting;
            g.lobe = lobe;
            g.weight = fit.weight;
            g.residual = float(best);
        }
        lighting_ = bestLighting;
        record("light and one lobe", int(timeline_.size()), best, 0);
        logInfo("one lobe, {}: residual {:.2f}, weight {:.3f} {:.3f} {:.3f}, {} unknowns, {:.1f} s", g.lobe->name, best,
                g.weight.x, g.weight.y, g.weight.z, lighting_.leaves.size() + surfaces_.size(), progress_.seconds());
        return;
    }
    const ViewRows rows = viewRows(progress_);
    const size_t ownRows = influence_.rows;
    computeLit();
    std::vector<uint32_t> fold = plan_.choices.mattePointsInDetail ? std::vector<uint32_t>() : leavesAsMatteTellsThem();
    const auto takeBack = [&](void*) {
        influence_.rows = ownRows;
        influence_.values.resize(ownRows * influence_.columns);
    };
    const std::unique_ptr<void, decltype(takeBack)> narrow(&influence_, takeBack);
    RatioProblem problem = ratiosWithMetals();
    problem.fold = std::move(fold);
    problem.foldedRows = ownRows;
    runAlbedoFree("light from ratios and gloss", iterations, &rows,
                  problem.observations.vertices.empty() ? nullptr : &problem);
}

RatioProblem SolveState::ratiosWithMetals() {
    RatioProblem all;
    if (std::none_of(gloss_.begin(), gloss_.end(), [](const ComponentGloss& g) { return !g.matte; })) return all;
    all.observations = matte_;
    all.pairs = pairs_;
    all.bounce = bounce_;
    // Noise in these rows would move the scale.
    LobeRowOptions fine = rowOptions();
    fine.lobeSamples *= 2;
    fine.cosineSamples *= 2;
    for (const ComponentGloss& g : gloss_) {
        if (g.matte || g.observations.size() < 2) continue;
        std::vector<Rgb> mirrored;
        const InfluenceMatrix lobe = glossyRows(scene_, surfaces_, clusters_.emitterOfTriangle, lighting_.leaves,
                                                *g.lobe, g.observations, fine, progress_, &mirrored);
        const size_t first = all.observations.vertices.size(), count = g.observations.size();
        influence_.values.reserve(influence_.values.size() + lobe.values.size());
        influence_.values.insert(influence_.values.end(), lobe.values.begin(), lobe.values.end());
        influence_.rows += count;
        for (size_t i = 0; i < count; ++i) {
            all.observations.vertices.push_back(g.observations[i].vertex);
            all.observations.radiance.push_back(g.observations[i].radiance);
            all.observations.sigma.push_back(Rgb(g.observations[i].sigma));
            if (!all.bounce.empty()) all.bounce.push_back(mirrored[i]);
            // Four partners for each: a look stands in eight pairs, which together weigh as much as the look would with
            // a known weight.
            for (uint64_t k = 1; k <= 4; ++k) {
                const size_t other = mixBits((options_.seed + k) * 0x1000003 + i) % count;
                if (other != i) all.pairs.push_back({uint32_t(first + i), uint32_t(first + other), 0.25f});
            }
        }
    }
    return all;
}

ViewRows SolveState::viewRows(Progress& progress) {
    ViewRows result;
    size_t total = 0;
    for (const ComponentGloss& g : gloss_) total += g.matte ? g.observations.size() : 0;
    const size_t columns = lighting_.leaves.size() + surfaces_.size();
    for (InfluenceMatrix& m : result.influence) {
        m.rows = total;
        m.columns = columns;
        m.values.assign(total * columns, 0.0f);
    }
    size_t at = 0;
    GlossOptions options;
    options.rows = rowOptions();
    for (const ComponentGloss& g : gloss_) {
        if (!g.matte) continue;
        std::vector<Rgb> mirrored;
        const InfluenceMatrix lobe = glossyRows(scene_, surfaces_, clusters_.emitterOfTriangle, lighting_.leaves,
                                                *g.lobe, g.observations, options.rows, progress, &mirrored);
        std::vector<uint32_t> vertices;
        for (const GlossyObservation& observation : g.observations) vertices.push_back(observation.vertex);
        const InfluenceMatrix lambert = rowsOf(vertices);
        for (size_t i = 0; i < g.observations.size(); ++i, ++at) {
            const Rgb albedo = !albedo_.albedo.empty() ? albedo_.albedo[g.observations[i].vertex] : Rgb(0);
            for (int c = 0; c < 3; ++c)
                for (size_t k = 0; k < columns; ++k)
                    result.influence[c].row(at)[k] = g.weight[c] * lobe.row(i)[k] + albedo[c] * lambert.row(i)[k];
            result.radiance.push_back(
                g.observations[i].radiance - g.weight * mirrored[i] -
                (vertexBounce_.empty() ? Rgb(0) : albedo * vertexBounce_[g.observations[i].vertex]));
            result.sigma.push_back(2.0f * g.observations[i].sigma);
        }
    }
    return result;
}

void SolveState::computeLit() {
    const size_t rows = influence_.rows;
    lit_.assign(rows, Rgb(0));
    parallelFor(rows, 64, [&](size_t i) {
        const Rgb sum = lightOfRow(influence_.row(i), lighting_);
        lit_[i] = bounce_.empty() ? sum : sum + bounce_[i];
    });
    // Shadow edges: an observation mixes irradiance with its neighbours'.
    litSigma_.assign(rows, Rgb(0));
    for (const AlbedoPair& p : pairs_) {
        if (p.weight != 1) continue;
        const Rgb step = glm::abs(lit_[p.a] - lit_[p.b]);
        litSigma_[p.a] = glm::max(litSigma_[p.a], 0.25f * step);
        litSigma_[p.b] = glm::max(litSigma_[p.b], 0.25f * step);
    }
    for (size_t i = 0; i < rows; ++i) litSigma_[i] = glm::sqrt(litSigma_[i] * litSigma_[i] + 1e-4f * lit_[i] * lit_[i]);
}

}  // namespace relamp
