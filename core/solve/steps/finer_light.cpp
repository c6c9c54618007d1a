// Which directions of the environment are told apart: leaves that are split, and leaves that only metals tell apart.
#include <map>

#include "solve/light/contributions.h"
#include "solve/steps/steps.h"

namespace relamp {
namespace {

LeafCell cellOf(const Leaf& leaf) { return {leaf.environment, leaf.level, leaf.x, leaf.y}; }
LeafCell parentOf(const Leaf& leaf) { return {leaf.environment, leaf.level - 1, leaf.x / 2, leaf.y / 2}; }

}  // namespace

bool refineLeaves(SolveRun& s) {
    if (s.light.refined) return false;
    const size_t limit = s.mostLeaves();
    if (s.light.environmentBlack || s.stopped() || s.light.lighting.leaves.size() >= limit) return false;
    finishVisibility(s);
    // What a leaf gives of the light at a vertex, on average over the vertices: a sky counts in the shadow of its sun,
    // where emitters are told from it.
    const Irradiance irradiance = s.irradiance();
    const double misfit = s.mismatch(irradiance);
    // The measure is a root of squares: a fifth of a percent of the squares is nothing.
    const bool explainedMore =
        s.light.refinedMisfit == 0 || misfit * misfit < 0.998 * s.light.refinedMisfit * s.light.refinedMisfit;
    if (!explainedMore && s.hasMatte() && !s.in.choices.flatLevels) {
        s.light.refined = true;
        return false;
    }
    s.light.refinedMisfit = misfit;
    const std::vector<Rgb> fractions = contributionsOf(s, irradiance);
    std::vector<std::pair<float, uint32_t>> strong;
    for (uint32_t i = 0; i < s.light.lighting.leaves.size(); ++i) {
        const Rgb fraction = fractions[i];
        if (maxChannel(fraction) > s.in.options.splitFraction &&
            s.light.lighting.leaves[i].level < LightLeaves::maxLevel)
            strong.emplace_back(maxChannel(fraction), i);
    }
    if (strong.empty()) return false;
    std::sort(strong.begin(), strong.end(), [](const auto& a, const auto& b) {
        return a.first != b.first ? a.first > b.first : a.second < b.second;
    });
    std::vector<uint32_t> chosen;
    for (const auto& [fraction, i] : strong)
        if (s.light.lighting.leaves.size() + 3 * (chosen.size() + 1) <= limit) chosen.push_back(i);
    s.splitLeaves(chosen);
    return !chosen.empty();
}

std::vector<Rgb> contributionsOf(const SolveRun& s, const Irradiance& irradiance) {
    std::vector<uint32_t> some;
    for (uint32_t r = 0; r < s.light.influence.rows; ++r)
        if (s.in.scene.rank[s.observed.matte.vertices[r]] % 5 == 0) some.push_back(r);
    std::vector<Rgb> fractions = lightContributions(s.light.influence, s.light.lighting, irradiance.value, some);
    const LightLeaves& leaves = s.light.lighting.leaves;
    if (s.in.samples.environmentOfState.empty()) return fractions;
    // Of the light of those states that have the leaf's environment.
    std::vector<size_t> lit(leaves.environments(), 0);
    for (const uint32_t r : some)
        if (const int e = leaves.environmentOf(s.observed.matte.stateOf(r)); e >= 0) ++lit[size_t(e)];
    for (size_t i = 0; i < fractions.size(); ++i)
        fractions[i] *= float(some.size()) / float(std::max<size_t>(1, lit[leaves[i].environment]));
    return fractions;
}

std::vector<uint8_t> peaksAmongBrothers(const LightLeaves& leaves, const std::vector<Rgb>& fractions) {
    constexpr float most = 0.4f;  // a sun on the border of two gives each of them half
    std::map<LeafCell, std::pair<float, int>> together;
    for (uint32_t i = 0; i < leaves.size(); ++i) {
        auto& [light, parts] = together[parentOf(leaves[i])];
        light += maxChannel(fractions[i]);
        ++parts;
    }
    std::vector<uint8_t> peaks(leaves.size(), 0);
    for (uint32_t i = 0; i < leaves.size(); ++i) {
        const auto& [light, parts] = together[parentOf(leaves[i])];
        peaks[i] = parts == 4 && maxChannel(fractions[i]) > most * light;
    }
    return peaks;
}

std::vector<uint32_t> leavesToDivide(const LightLeaves& leaves, const std::vector<Rgb>& fractions, bool explained,
                                     std::set<LeafCell>* divided) {
    const std::vector<uint8_t> peaks =
        divided ? peaksAmongBrothers(leaves, fractions) : std::vector<uint8_t>(leaves.size());
    std::vector<uint32_t> strong;
    for (uint32_t i = 0; i < leaves.size(); ++i)
        if (maxChannel(fractions[i]) > StrongDirections::fraction && leaves[i].level < StrongDirections::finest &&
            (explained || peaks[i] || (divided && divided->count(parentOf(leaves[i])) > 0)))
            strong.push_back(i);
    for (const uint32_t i : strong)
        if (peaks[i]) divided->insert(cellOf(leaves[i]));
    return strong;
}

std::vector<uint32_t> leavesAsMatteTellsThem(const SolveRun& s, const Irradiance& irradiance) {
    const std::vector<Rgb> fraction = contributionsOf(s, irradiance);
    const size_t leaves = s.light.lighting.leaves.size();
    std::map<LeafCell, std::vector<uint32_t>> brothers;
    for (uint32_t i = 0; i < leaves; ++i) {
        const Leaf& leaf = s.light.lighting.leaves[i];
        if (leaf.level > s.in.options.startLevel) brothers[parentOf(leaf)].push_back(i);
    }
    constexpr uint32_t alone = ~0u;
    std::vector<uint32_t> group(s.light.influence.columns, alone);
    uint32_t groups = 0;
    bool any = false;
    for (const auto& [parent, children] : brothers) {
        Rgb together(0);
        for (const uint32_t i : children) together += fraction[i];
        if (children.size() < 4 || maxChannel(together) > s.in.options.splitFraction) continue;
        for (const uint32_t i : children) group[i] = groups;
        ++groups;
        any = true;
    }
    if (!any) return {};
    for (uint32_t& g : group)
        if (g == alone) g = groups++;
    return group;
}

bool sharpenForMetals(SolveRun& s) {
    if (!s.hasMatte() || s.light.environmentBlack || !s.gloss.hasMetal()) return false;
    constexpr uint8_t wanted = 5;
    std::vector<uint8_t> differs(s.light.lighting.leaves.size(), 0);
    for (const auto& [i, j] : s.light.lighting.leaves.neighbourPairs()) {
        const Rgb a = s.light.lighting.leafRadiance[i], b = s.light.lighting.leafRadiance[j];
        if (maxChannel(glm::abs(a - b) / glm::max(a + b, Rgb(1e-20f))) > 0.1f) differs[i] = differs[j] = 1;
    }
    std::vector<uint32_t> coarse;
    for (uint32_t i = 0; i < s.light.lighting.leaves.size(); ++i)
        if (s.light.lighting.leaves[i].level < wanted && differs[i]) coarse.push_back(i);
    s.splitLeaves(coarse);
    return true;
}

}  // namespace relamp
