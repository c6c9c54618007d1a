// The first answer: coarse light, which emitters are emitters, strong directions finer than the rest, and lobes by a
// few looks.
#include "base/log.h"
#include "solve/solve_state.h"

namespace relamp {

void SolveState::firstLight() {
    joinLikelyBounce();
    runAlbedoFree("light from ratios, coarse", options_.startIterations, nullptr, nullptr, {}, FitEnd::coarse);
    if (confirmEmitters()) {
        joinLikelyBounce();
        runAlbedoFree("light from ratios, coarse", options_.startIterations, nullptr, nullptr, {}, FitEnd::coarse);
    }
    leaveOutBlackEnvironment();
    if (!bounce_.empty()) updateBounce();
    if (stopped()) return;
    const Lighting without = lighting_;
    try {
        const Progress::Dispensable mayEnd(progress_);
        decideBounce(true);
    } catch (const OutOfTime&) {
        lighting_ = without;
        forgetBounce("the time was used up before it could be tried");
    }
}

void SolveState::sharpenStrong() {
    if (environmentBlack_ || firstLevel() >= options_.startLevel) return;
    double misfit = std::numeric_limits<double>::infinity();
    for (int round = 0; round < StrongDirections::rounds && !stopped(); ++round) {
        computeLit();
        // The measure is a root of squares: a fiftieth of the squares is worth another round.
        const double before = misfit;
        misfit = pairMismatch();
        if (misfit * misfit > 0.98 * before * before) return;
        const std::vector<Rgb> fractions = lightContributions();
        std::vector<uint32_t> strong;
        for (uint32_t i = 0; i < fractions.size(); ++i)
            if (maxChannel(fractions[i]) > StrongDirections::fraction &&
                lighting_.leaves[i].level < StrongDirections::finest)
                strong.push_back(i);
        if (strong.empty()) return;
        splitLeaves(strong);
        runAlbedoFree("light from ratios, coarse", 4, nullptr, nullptr, {}, FitEnd::coarse);
        if (!stopped()) keepForCut();
    }
}

void SolveState::firstSurfaces() {
    if (stopped()) return;
    GlossOptions options;
    options.seed = options_.seed;
    options.rows = rowOptions();
    options.rows.lobeSamples = 48;
    options.rows.cosineSamples = 24;
    options.rows.emitterSamples = 16;
    options.maxVertices = 120;
    const std::vector<size_t> sizes = observationsOfComponents(scene_, matte_);
    firstGloss_.clear();
    for (uint32_t p = 0; p < scene_.components; ++p) {
        if (!matte_.componentGlossy[p] || sizes[p] < 30) continue;
        const bool metal = matte_.componentGlossy[p] == 2;
        options.lambertGain = metal ? 1e30f : 1.6f;
        ComponentGloss g = fitGloss(capture_, scene_, samples_, surfaces_, clusters_.emitterOfTriangle, lighting_,
                                    builtInBasis(), p, options, progress_);
        if (g.lobe) firstGloss_.push_back(std::move(g));
    }
}

void SolveState::startLight() {
    if (environmentBlack_) return;
    std::vector<uint32_t> coarse;
    for (uint32_t i = 0; i < lighting_.leaves.size(); ++i)
        if (lighting_.leaves[i].level < options_.startLevel) coarse.push_back(i);
    meter_.begin(Stage::visibility);
    learnVisibility(visibilityStepFor(options_.startLevel));
    meter_.begin(Stage::light);
    if (!coarse.empty()) splitLeaves(coarse);
    runAlbedoFree("light from ratios", options_.startIterations, nullptr);
}

bool SolveState::confirmEmitters() {
    if (clusters_.emitters.empty()) return false;
    std::vector<EmitterCluster> kept;
    for (size_t e = 0; e < clusters_.emitters.size(); ++e) {
        EmitterCluster& cluster = clusters_.emitters[e];
        // Light that reaches the patch from everything but itself.
        std::vector<uint32_t> some, spread = cluster.vertices;
        std::sort(spread.begin(), spread.end(),
                  [&](uint32_t a, uint32_t b) { return scene_.rank[a] < scene_.rank[b]; });
        const size_t step = std::max<size_t>(1, spread.size() / 64);
        for (size_t i = 0; i < spread.size(); i += step)
            if (samples_.countOf(spread[i]) > 0) some.push_back(spread[i]);
        if (some.empty()) some.assign(1, cluster.vertices[0]);
        const InfluenceMatrix rows = rowsOf(some);
        std::vector<float> demanded;
        for (size_t i = 0; i < some.size(); ++i) {
            Rgb lit(0);
            for (size_t k = 0; k < lighting_.leaves.size(); ++k) lit += rows.row(i)[k] * lighting_.leafRadiance[k];
            for (size_t o = 0; o < clusters_.emitters.size(); ++o)
                if (o != e) lit += rows.row(i)[lighting_.leaves.size() + o] * lighting_.emitterRadiance[o];
            float worst = 0;
            for (int c = 0; c < 3; ++c)
                if (cluster.radiance[c] > 0.2f * maxChannel(cluster.radiance))
                    worst = std::max(worst, cluster.radiance[c] / std::max(lit[c], 1e-12f));
            demanded.push_back(worst);
        }
        std::nth_element(demanded.begin(), demanded.begin() + ptrdiff_t(demanded.size() / 2), demanded.end());
        cluster.evidence.demandedAlbedo = std::min(demanded[demanded.size() / 2], 1e6f);
        logInfo("patch of radiance {:.3g} {:.3g} {:.3g}: reflection would need an albedo of {:.3g}", cluster.radiance.x,
                cluster.radiance.y, cluster.radiance.z, cluster.evidence.demandedAlbedo);
        if (suspect_[e] && cluster.evidence.demandedAlbedo < 1.5f)
            clusters_.rejected.push_back({cluster.centroid, cluster.radiance, cluster.evidence,
                                          "the other lights explain it as a reflecting surface"});
        else kept.push_back(cluster);
    }
    const bool changed = kept.size() != clusters_.emitters.size();
    clusters_.emitters = std::move(kept);
    suspect_.assign(clusters_.emitters.size(), 0);
    indexEmitters(scene_, clusters_);
    if (!changed) return false;
    rebuildNearField();
    rebuildRows();
    lighting_.emitterRadiance = firstRadiance(clusters_);
    return true;
}

void SolveState::leaveOutBlackEnvironment() {
    if (surfaces_.empty() || matte_.radiance.empty()) return;
    double distant = 0, all = 0;
    for (size_t r = 0; r < influence_.rows; ++r)
        for (size_t k = 0; k < influence_.columns; ++k) {
            const bool leaf = k < lighting_.leaves.size();
            const double light =
                double(influence_.row(r)[k]) *
                luminance(leaf ? lighting_.leafRadiance[k] : lighting_.emitterRadiance[k - lighting_.leaves.size()]);
            all += light;
            if (leaf) distant += light;
        }
    logInfo("distant light gives {:.2g} % of the light on the surfaces", all > 0 ? 100 * distant / all : 0.0);
    // Where the background is seen and black, a little light from beside it is what the fit could not place.
    const double background = backgroundOverSurfaces(samples_, matte_);
    const bool black = background >= 0 && background < 0.05;
    if (!(distant < (black ? 0.03 : 0.005) * all)) return;
    environmentBlack_ = true;
    std::fill(lighting_.leafRadiance.begin(), lighting_.leafRadiance.end(), Rgb(0));
}

}  // namespace relamp
