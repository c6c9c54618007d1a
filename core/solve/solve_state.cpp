#include "solve/solve_state.h"

#include "base/log.h"
#include "base/parallel.h"

namespace relamp {

SolveState::SolveState(const Capture& capture, const Scene& scene, const RadianceSamples& samples, const SolveOptions& options, Progress& progress)
    : capture_(capture), scene_(scene), samples_(samples), options_(options), progress_(progress) {}

void SolveState::record(const std::string& stage, int iteration, double objective, double rmse) {
    timeline_.push_back({progress_.seconds(), stage, iteration, objective, rmse});
}

void SolveState::takeClusters(const EmitterClusters& clusters) {
    clusters_ = clusters;
    if (!options_.nearField) {
        clusters_.emitters.clear();
        clusters_.candidates.clear();
    }
    // Candidates take part as lamps until the light fit has judged them.
    for (EmitterCluster& c : clusters_.emitters) c.evidence.demandedAlbedo = 0;
    const size_t certain = clusters_.emitters.size();
    std::vector<EmitterCluster> all = clusters_.emitters;
    all.insert(all.end(), clusters_.candidates.begin(), clusters_.candidates.end());
    clusters_.candidates.clear();
    suspect_.assign(all.size(), 0);
    for (size_t i = certain; i < all.size(); ++i) suspect_[i] = 1;
    clusters_.emitters = all;
    // Not indexEmitters: its sorting would lose track of the suspects.
    clusters_.emitterOfVertex.assign(scene_.mesh.vertexCount(), -1);
    clusters_.emitterOfTriangle.assign(scene_.mesh.triangles.size(), -1);
    for (size_t i = 0; i < all.size(); ++i) {
        for (uint32_t v : all[i].vertices) clusters_.emitterOfVertex[v] = int(i);
        for (uint32_t t : all[i].triangles) clusters_.emitterOfTriangle[t] = int(i);
    }
}

void SolveState::rebuildNearField() {
    surfaces_.clear();
    for (const EmitterCluster& e : clusters_.emitters) surfaces_.push_back(emitterSurface(scene_.mesh, e));
    NearFieldOptions nearOptions;
    nearOptions.seed = options_.seed;
    nearField_ = computeNearField(scene_, clusters_, nearOptions, progress_);
    std::vector<uint8_t> skip(scene_.mesh.vertexCount(), 0);
    for (size_t v = 0; v < skip.size(); ++v) skip[v] = clusters_.emitterOfVertex[v] >= 0;
    matte_ = matteObservations(scene_, samples_, skip);
    PairOptions pairOptions;
    pairOptions.seed = options_.seed;
    pairs_ = albedoPairs(scene_, matte_, pairOptions);
    size_t usable = 0;
    for (uint32_t v : matte_.vertices) usable += matte_.pieceGlossy[scene_.piece[v]] < 2;
    matteShare_ = matte_.vertices.empty() ? 0 : double(usable) / double(matte_.vertices.size());
}

void SolveState::prepare() {
    VisibilityOptions visibilityOptions;
    visibilityOptions.gridSide = options_.visibilitySide;
    visibility_ = computeVisibility(scene_, visibilityOptions, progress_);
    rebuildNearField();
    if (matte_.vertices.empty()) throw Error("no vertex of the mesh is seen by any photograph: check the cameras' poses and the mesh's scale with `relamp check`");
    uniformLight();
}

void SolveState::uniformLight() {
    lighting_.leaves = LightLeaves::uniform(options_.startLevel);
    anchors_ = lightAnchors(samples_, clusters_, lighting_.leaves);
    lighting_.emitterRadiance = anchors_.emitterRadiance;
    influence_ = lambertInfluence(scene_, visibility_, nearField_, lighting_.leaves, matte_.vertices, progress_);
    // A constant environment that would show the median radiance on an albedo of 0.3.
    std::vector<float> values;
    for (int c = 0; c < 3; ++c) {
        values.clear();
        for (const Rgb& y : matte_.radiance) values.push_back(y[c]);
        std::nth_element(values.begin(), values.begin() + ptrdiff_t(values.size() / 2), values.end());
        const float start = std::max(values[values.size() / 2] / 0.3f, 1e-9f);
        if (c == 0) lighting_.leafRadiance.assign(lighting_.leaves.size(), Rgb(0));
        for (Rgb& l : lighting_.leafRadiance) l[c] = start;
    }
}

void SolveState::runAlbedoFree(const std::string& stage, int iterations, const ViewRows* rows) {
    AlbedoFreeOptions o;
    o.iterations = iterations;
    o.anneal = timeline_.empty();
    const AlbedoFreeReport report = solveAlbedoFree(influence_, matte_, pairs_, anchors_, rows, o, lighting_, progress_,
                                                    [&](int i, double objective, double rmse) { record(stage, i, objective, rmse); });
    stability_.kktResidual = std::max(stability_.kktResidual, report.kktResidual);
    logInfo("{}: {} iterations, objective {:.4g}, {} unknowns, {:.1f} s", stage, report.iterations, report.objective, lighting_.leaves.size() + surfaces_.size(), progress_.seconds());
}

void SolveState::startFromRatios() { runAlbedoFree("light from ratios", options_.startIterations, nullptr); }

void SolveState::startFromConstantReflectance() {
    // The piece with the most look-ups stands for the scene.
    std::vector<size_t> looksOf(scene_.pieces, 0);
    for (uint32_t v : matte_.vertices) looksOf[scene_.piece[v]] += samples_.countOf(v);
    const uint32_t piece = uint32_t(std::max_element(looksOf.begin(), looksOf.end()) - looksOf.begin());
    GlossOptions options;
    options.seed = options_.seed;
    options.maxVertices = 1500;
    const std::vector<GlossyLook> looks = glossyLooks(capture_, scene_, samples_, piece, options);
    if (looks.size() < 40) {
        startFromRatios();
        return;
    }
    const size_t leaves = lighting_.leaves.size();
    double best = 1e300;
    Lighting bestLighting = lighting_;
    PieceGloss chosen;
    for (size_t k = 1; k < basis_.lobes.size(); ++k) {
        if (basis_.lobes[k].kind != Lobe::Kind::ggx) continue;
        const InfluenceMatrix rows = glossyRows(scene_, surfaces_, clusters_.emitterOfTriangle, lighting_.leaves, basis_.lobes[k], looks, options.rows, progress_);
        // y = w (D L + N P): unknowns are w L and w P, and P is known, so w follows.
        Lighting trial = lighting_;
        Rgb weight(1);
        double residual = 0;
        std::vector<Rgb> model(looks.size(), Rgb(0));
        for (int c = 0; c < 3; ++c) {
            std::vector<float> w(looks.size(), 1);
            QpResult solution;
            for (int round = 0; round < 3; ++round) {
                const auto weightOf = [&](size_t i) { return w[i] / (looks[i].sigma * looks[i].sigma); };
                Eigen::MatrixXd q = weightedGram(rows, [&](size_t i, float* out) {
                    for (size_t j = 0; j < rows.columns; ++j) out[j] = weightOf(i) * rows.row(i)[j];
                }, progress_);
                Eigen::VectorXd moment = Eigen::VectorXd::Zero(Eigen::Index(rows.columns));
                for (size_t i = 0; i < rows.rows; ++i)
                    for (size_t j = 0; j < rows.columns; ++j) moment(Eigen::Index(j)) += double(weightOf(i)) * looks[i].radiance[c] * rows.row(i)[j];
                const double ridge = 1e-5 * q.diagonal().maxCoeff();
                for (const auto& [i, j] : lighting_.leaves.neighbourPairs()) {
                    q(i, i) += ridge;
                    q(j, j) += ridge;
                    q(i, j) -= ridge;
                    q(j, i) -= ridge;
                }
                solution = solveBoundedQp(q, moment, Eigen::VectorXd::Zero(moment.size()));
                for (size_t i = 0; i < rows.rows; ++i) {
                    double y = 0;
                    for (size_t j = 0; j < rows.columns; ++j) y += double(rows.row(i)[j]) * solution.x(Eigen::Index(j));
                    model[i][c] = float(y);
                    const double r = (y - looks[i].radiance[c]) / looks[i].sigma;
                    w[i] = float(1 / (1 + r * r / 9));
                    if (round == 2) residual += 9 * std::log1p(r * r / 9);
                }
            }
            // The weight: from the strongest lamp in this channel, else from the background.
            double num = 0, den = 0;
            for (size_t e = 0; e < surfaces_.size(); ++e) {
                num += solution.x(Eigen::Index(leaves + e)) * double(anchors_.emitterRadiance[e][c]) * surfaces_[e].area();
                den += double(anchors_.emitterRadiance[e][c]) * double(anchors_.emitterRadiance[e][c]) * surfaces_[e].area();
            }
            if (den <= 0 || num <= 0)
                for (size_t i = 0; i < leaves; ++i) {
                    if (anchors_.leaves[i].coverage < 0.5f) continue;
                    num += solution.x(Eigen::Index(i)) * anchors_.leaves[i].radiance[c];
                    den += double(anchors_.leaves[i].radiance[c]) * anchors_.leaves[i].radiance[c];
                }
            weight[c] = den > 0 && num > 0 ? float(num / den) : 0.7f;
            for (size_t i = 0; i < leaves; ++i) trial.leafRadiance[i][c] = float(solution.x(Eigen::Index(i)) / weight[c]);
        }
        residual /= double(3 * looks.size());
        record("light from one lobe", int(k), residual, 0);
        logInfo("one lobe {}: residual {:.3f}, weight {:.3f} {:.3f} {:.3f}", basis_.lobes[k].name, residual, weight.x, weight.y, weight.z);
        if (residual < best) {
            best = residual;
            bestLighting = trial;
            chosen.piece = piece;
            chosen.lobe = int(k);
            chosen.weight = weight;
            chosen.matte = false;
            chosen.residual = float(residual);
            chosen.looks = looks;
        }
    }
    lighting_ = bestLighting;
    gloss_.assign(1, chosen);
}

bool SolveState::confirmEmitters() {
    if (clusters_.emitters.empty()) return false;
    computeLit();
    const InfluenceMatrix& unused = influence_;
    (void)unused;
    std::vector<EmitterCluster> kept;
    std::vector<uint8_t> keptSuspect;
    bool changed = false;
    for (size_t e = 0; e < clusters_.emitters.size(); ++e) {
        EmitterCluster& cluster = clusters_.emitters[e];
        // Light that reaches the patch from everything but itself.
        std::vector<uint32_t> some;
        const size_t step = std::max<size_t>(1, cluster.vertices.size() / 64);
        for (size_t i = 0; i < cluster.vertices.size(); i += step)
            if (samples_.countOf(cluster.vertices[i]) > 0) some.push_back(cluster.vertices[i]);
        if (some.empty()) some.assign(1, cluster.vertices[0]);
        const InfluenceMatrix rows = lambertInfluence(scene_, visibility_, nearField_, lighting_.leaves, some, progress_);
        std::vector<float> demanded;
        for (size_t i = 0; i < some.size(); ++i) {
            Rgb lit(0);
            for (size_t k = 0; k < lighting_.leaves.size(); ++k) lit += rows.row(i)[k] * lighting_.leafRadiance[k];
            for (size_t o = 0; o < clusters_.emitters.size(); ++o)
                if (o != e) lit += rows.row(i)[lighting_.leaves.size() + o] * lighting_.emitterRadiance[o];
            float worst = 0;
            for (int c = 0; c < 3; ++c)
                if (cluster.radiance[c] > 0.2f * maxChannel(cluster.radiance)) worst = std::max(worst, cluster.radiance[c] / std::max(lit[c], 1e-12f));
            demanded.push_back(worst);
        }
        std::nth_element(demanded.begin(), demanded.begin() + ptrdiff_t(demanded.size() / 2), demanded.end());
        cluster.evidence.demandedAlbedo = std::min(demanded[demanded.size() / 2], 1e6f);
        logInfo("patch of radiance {:.3g} {:.3g} {:.3g}: reflection would need an albedo of {:.3g}", cluster.radiance.x, cluster.radiance.y, cluster.radiance.z, cluster.evidence.demandedAlbedo);
        if (suspect_[e] && cluster.evidence.demandedAlbedo < 1.5f) {
            changed = true;
            clusters_.rejected.push_back({cluster.centroid, cluster.radiance, cluster.evidence, "the other lights explain it as a reflecting surface"});
            continue;
        }
        kept.push_back(cluster);
        keptSuspect.push_back(0);
    }
    const bool reordered = kept.size() != clusters_.emitters.size();
    clusters_.emitters = kept;
    suspect_ = keptSuspect;
    indexEmitters(scene_, clusters_);
    if (reordered || changed || true) {
        // Order may have changed: radiances and columns follow it.
        rebuildNearField();
        const LightLeaves leaves = lighting_.leaves;
        const std::vector<Rgb> radiance = lighting_.leafRadiance;
        anchors_ = lightAnchors(samples_, clusters_, leaves);
        lighting_.emitterRadiance = anchors_.emitterRadiance;
        influence_ = lambertInfluence(scene_, visibility_, nearField_, leaves, matte_.vertices, progress_);
    }
    return changed;
}

bool SolveState::refineLeaves() {
    if (stopped() || lighting_.leaves.size() >= options_.maxLeaves) return false;
    Rgb total(0);
    for (size_t i = 0; i < lighting_.leaves.size(); ++i) total += lighting_.leafRadiance[i] * lighting_.leaves[i].solidAngle();
    std::vector<std::pair<float, uint32_t>> strong;
    for (uint32_t i = 0; i < lighting_.leaves.size(); ++i) {
        const Rgb share = lighting_.leafRadiance[i] * lighting_.leaves[i].solidAngle() / glm::max(total, Rgb(1e-30f));
        if (maxChannel(share) > options_.splitShare && lighting_.leaves[i].level < LightLeaves::maxLevel) strong.emplace_back(maxChannel(share), i);
    }
    if (strong.empty()) return false;
    std::sort(strong.begin(), strong.end(), [](const auto& a, const auto& b) { return a.first != b.first ? a.first > b.first : a.second < b.second; });
    const size_t before = lighting_.leaves.size();
    std::vector<uint32_t> changed;
    for (const auto& [share, i] : strong) {
        if (lighting_.leaves.size() + 3 > options_.maxLeaves) break;
        const size_t first = lighting_.leaves.size();
        lighting_.leaves.split(i);
        changed.push_back(i);
        for (size_t k = first; k < lighting_.leaves.size(); ++k) {
            lighting_.leafRadiance.push_back(lighting_.leafRadiance[i]);
            changed.push_back(uint32_t(k));
        }
    }
    InfluenceMatrix wider;
    wider.rows = influence_.rows;
    wider.columns = lighting_.leaves.size() + surfaces_.size();
    wider.values.assign(wider.rows * wider.columns, 0.0f);
    for (size_t r = 0; r < wider.rows; ++r) {
        std::copy(influence_.row(r), influence_.row(r) + before, wider.row(r));
        std::copy(influence_.row(r) + before, influence_.row(r) + influence_.columns, wider.row(r) + lighting_.leaves.size());
    }
    influence_ = std::move(wider);
    lambertInfluenceOfLeaves(scene_, visibility_, lighting_.leaves, matte_.vertices, changed, influence_, progress_);
    anchors_ = lightAnchors(samples_, clusters_, lighting_.leaves);
    return true;
}

void SolveState::improveLight(int iterations) {
    if (stopped()) return;
    if (gloss_.empty()) {
        runAlbedoFree("light from ratios", iterations, nullptr);
        return;
    }
    const ViewRows rows = viewRows(progress_);
    runAlbedoFree("light from ratios and gloss", iterations, &rows);
}

ViewRows SolveState::viewRows(Progress& progress) {
    ViewRows result;
    size_t total = 0;
    for (const PieceGloss& g : gloss_) total += g.looks.size();
    const size_t columns = lighting_.leaves.size() + surfaces_.size();
    for (InfluenceMatrix& m : result.influence) {
        m.rows = total;
        m.columns = columns;
        m.values.assign(total * columns, 0.0f);
    }
    size_t at = 0;
    GlossOptions options;
    for (const PieceGloss& g : gloss_) {
        const InfluenceMatrix lobe = glossyRows(scene_, surfaces_, clusters_.emitterOfTriangle, lighting_.leaves, basis_.lobes[size_t(g.lobe)], g.looks, options.rows, progress);
        std::vector<uint32_t> vertices;
        for (const GlossyLook& look : g.looks) vertices.push_back(look.vertex);
        InfluenceMatrix lambert;
        if (g.matte) lambert = lambertInfluence(scene_, visibility_, nearField_, lighting_.leaves, vertices, progress);
        for (size_t i = 0; i < g.looks.size(); ++i, ++at) {
            const Rgb albedo = g.matte && !albedo_.albedo.empty() ? albedo_.albedo[g.looks[i].vertex] : Rgb(0);
            for (int c = 0; c < 3; ++c)
                for (size_t k = 0; k < columns; ++k)
                    result.influence[c].row(at)[k] = g.weight[c] * lobe.row(i)[k] + (g.matte ? albedo[c] * lambert.row(i)[k] : 0.0f);
            result.radiance.push_back(g.looks[i].radiance);
            result.sigma.push_back(g.looks[i].sigma * (g.matte ? 2.0f : 1.0f));
        }
    }
    return result;
}

void SolveState::computeLit() {
    const size_t rows = influence_.rows, leaves = lighting_.leaves.size();
    lit_.assign(rows, Rgb(0));
    parallelFor(rows, 64, [&](size_t i) {
        const float* row = influence_.row(i);
        Rgb sum(0);
        for (size_t k = 0; k < leaves; ++k) sum += row[k] * lighting_.leafRadiance[k];
        for (size_t e = 0; e < lighting_.emitterRadiance.size(); ++e) sum += row[leaves + e] * lighting_.emitterRadiance[e];
        lit_[i] = sum;
    });
    // Shadow edges: a look-up mixes irradiance with its neighbours'.
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
