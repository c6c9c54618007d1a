// Which directions of the environment is told apart: leaves that are split, and leaves that only metals tell apart.
#include <map>

#include "solve/light/contributions.h"
#include "solve/solve_state.h"

namespace relamp {

bool SolveState::refineLeaves() {
    if (refined_) return false;
    const size_t limit =
        hasMatte() ? options_.maxLeaves : options_.maxLeaves + 3 * (size_t(1) << (2 * options_.startLevel));
    if (environmentBlack_ || stopped() || lighting_.leaves.size() >= limit) return false;
    finishVisibility();
    // What a leaf gives of the light at a vertex, on average over the vertices: a sky counts in the shadow of its sun,
    // where emitters are told from it.
    computeLit();
    const double misfit = pairMismatch();
    // The measure is a root of squares: a fifth of a percent of the squares is nothing.
    const bool explainedMore = refinedMisfit_ == 0 || misfit * misfit < 0.998 * refinedMisfit_ * refinedMisfit_;
    if (!explainedMore && hasMatte() && !plan_.choices.flatLevels) {
        refined_ = true;
        return false;
    }
    refinedMisfit_ = misfit;
    const std::vector<Rgb> fractions = lightContributions();
    std::vector<std::pair<float, uint32_t>> strong;
    for (uint32_t i = 0; i < lighting_.leaves.size(); ++i) {
        const Rgb fraction = fractions[i];
        if (maxChannel(fraction) > options_.splitFraction && lighting_.leaves[i].level < LightLeaves::maxLevel)
            strong.emplace_back(maxChannel(fraction), i);
    }
    if (strong.empty()) return false;
    std::sort(strong.begin(), strong.end(), [](const auto& a, const auto& b) {
        return a.first != b.first ? a.first > b.first : a.second < b.second;
    });
    std::vector<uint32_t> chosen;
    for (const auto& [fraction, i] : strong)
        if (lighting_.leaves.size() + 3 * (chosen.size() + 1) <= limit) chosen.push_back(i);
    splitLeaves(chosen);
    return !chosen.empty();
}

std::vector<Rgb> SolveState::lightContributions() const {
    std::vector<uint32_t> some;
    for (uint32_t r = 0; r < influence_.rows; ++r)
        if (scene_.rank[matte_.vertices[r]] % 5 == 0) some.push_back(r);
    return relamp::lightContributions(influence_, lighting_, lit_, some);
}

std::vector<uint32_t> SolveState::leavesAsMatteTellsThem() const {
    const std::vector<Rgb> fraction = lightContributions();
    const size_t leaves = lighting_.leaves.size();
    std::map<std::tuple<int, int, int>, std::vector<uint32_t>> brothers;
    for (uint32_t i = 0; i < leaves; ++i) {
        const Leaf& leaf = lighting_.leaves[i];
        if (leaf.level > options_.startLevel) brothers[{leaf.level, leaf.x / 2, leaf.y / 2}].push_back(i);
    }
    constexpr uint32_t alone = ~0u;
    std::vector<uint32_t> group(influence_.columns, alone);
    uint32_t groups = 0;
    bool any = false;
    for (const auto& [parent, children] : brothers) {
        Rgb together(0);
        for (const uint32_t i : children) together += fraction[i];
        if (children.size() < 4 || maxChannel(together) > options_.splitFraction) continue;
        for (const uint32_t i : children) group[i] = groups;
        ++groups;
        any = true;
    }
    if (!any) return {};
    for (uint32_t& g : group)
        if (g == alone) g = groups++;
    return group;
}

void SolveState::splitLeaves(const std::vector<uint32_t>& chosen) {
    // Nothing of the state changes before everything is there: the work may be given up in the middle.
    Lighting finer = lighting_;
    const size_t before = finer.leaves.size();
    std::vector<uint32_t> changed;
    for (uint32_t i : chosen) {
        const size_t first = finer.leaves.size();
        finer.leaves.split(i);
        changed.push_back(i);
        for (size_t k = first; k < finer.leaves.size(); ++k) {
            finer.leafRadiance.push_back(finer.leafRadiance[i]);
            changed.push_back(uint32_t(k));
        }
    }
    InfluenceMatrix wider;
    wider.rows = influence_.rows;
    wider.columns = finer.leaves.size() + surfaces_.size();
    size_t metalObservations = 0;  // come behind the rows for a while
    for (const ComponentGloss& g : gloss_) metalObservations += g.matte ? 0 : g.observations.size();
    wider.values.reserve((wider.rows + metalObservations) * wider.columns);
    wider.values.assign(wider.rows * wider.columns, 0.0f);
    for (size_t r = 0; r < wider.rows; ++r) {
        std::copy(influence_.row(r), influence_.row(r) + before, wider.row(r));
        std::copy(influence_.row(r) + before, influence_.row(r) + influence_.columns,
                  wider.row(r) + finer.leaves.size());
    }
    if (visibility_.step > 1) traceFinerLeaves(finer.leaves, known_);
    lambertInfluenceOfLeaves(scene_, visibility_, finer.leaves, matte_.vertices, changed, wider, progress_);
    influence_ = std::move(wider);
    lighting_ = std::move(finer);
    anchorLight();
    shapeLeaves();
    // What the background shows in detail is known at once.
    for (const uint32_t k : changed)
        if (const LeafAnchor& a = anchors_.leaves[k]; a.coverage > 0.95f && !a.clipped)
            lighting_.leafRadiance[k] = a.radiance;
}

void SolveState::sharpenForMetals() {
    if (!hasMatte() || environmentBlack_ ||
        std::none_of(gloss_.begin(), gloss_.end(), [](const ComponentGloss& g) { return !g.matte; }))
        return;
    constexpr uint8_t wanted = 5;
    std::vector<uint8_t> differs(lighting_.leaves.size(), 0);
    for (const auto& [i, j] : lighting_.leaves.neighbourPairs()) {
        const Rgb a = lighting_.leafRadiance[i], b = lighting_.leafRadiance[j];
        if (maxChannel(glm::abs(a - b) / glm::max(a + b, Rgb(1e-20f))) > 0.1f) differs[i] = differs[j] = 1;
    }
    std::vector<uint32_t> coarse;
    for (uint32_t i = 0; i < lighting_.leaves.size(); ++i)
        if (lighting_.leaves[i].level < wanted && differs[i]) coarse.push_back(i);
    splitLeaves(coarse);
    computeLit();
}

}  // namespace relamp
