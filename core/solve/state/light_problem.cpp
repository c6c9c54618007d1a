#include "solve/state/light_problem.h"

#include "base/log.h"

namespace relamp {

void LightProblem::computeNearField(const SolveInput& in, const EmitterDecision& emitters) {
    known = in.scene.referenced;
    if (!in.choices.unobservedVertices)
        for (uint32_t v = 0; v < known.size(); ++v)
            known[v] = in.samples.countOf(v) > 0 || emitters.clusters.emitterOfVertex[v] >= 0;
    NearFieldOptions options;
    options.seed = in.options.seed;
    options.only = &known;
    nearField = relamp::computeNearField(in.scene, emitters.clusters, options, in.progress);
}

void LightProblem::guess(const EmitterClusters& emitters, const MatteObservations& matte) {
    lighting.emitterRadiance = firstRadiance(emitters);
    lighting.leafRadiance.assign(lighting.leaves.size(), Rgb(0));
    if (environmentBlack) return;
    // A constant environment that would show the median radiance on an albedo of 0.3.
    std::vector<float> values;
    for (int c = 0; c < 3; ++c) {
        values.clear();
        for (const Rgb& y : matte.radiance) values.push_back(y[c]);
        std::nth_element(values.begin(), values.begin() + ptrdiff_t(values.size() / 2), values.end());
        const float start = std::max(values[values.size() / 2] / 0.3f, 1e-9f);
        for (Rgb& l : lighting.leafRadiance) l[c] = start;
    }
}

void LightProblem::takeStrength(const PriorStrength& strength) {
    prior.smoothness = LightPriorOptions{}.smoothness * strength.factor;
    smoothness = strength;
}

int LightProblem::firstLevel(const SolveInput& in, bool hasMatte) const {
    if (environmentBlack) return 0;
    const int start = in.options.startLevel;
    return in.options.nearField && hasMatte ? std::max(2, start - 1) : start;
}

int LightProblem::visibilityStepFor(const SolveInput& in, bool hasMatte, int level) const {
    const int start = in.options.startLevel;
    const bool coarseFirst = firstLevel(in, hasMatte) < start && level <= start;
    return coarseFirst ? std::max(1, in.options.visibilitySide >> (level + 1)) : 1;
}

void LightProblem::learnVisibility(const SolveInput& in, int step) {
    if (!visibility.bits.empty()) {
        refineVisibility(in.scene, known, step, in.choices.agreeingRays, visibility, in.progress);
    } else {
        VisibilityOptions options;
        options.gridSide = in.options.visibilitySide;
        options.axes = in.scene.axes;
        options.only = &known;
        options.step = step;
        options.agreeing = in.choices.agreeingRays;
        visibility = computeVisibility(in.scene, options, in.progress);
    }
    traceFinerLeaves(in, lighting.leaves, known);
}

void LightProblem::traceFinerLeaves(const SolveInput& in, const LightLeaves& leaves, const std::vector<uint8_t>& only) {
    std::vector<FinerDirections> blocks;
    for (size_t i = 0; i < leaves.size(); ++i) {
        const int side = visibility.grid.side >> leaves[i].level, step = std::max(1, side / 2);
        if (side < 1 || step >= visibility.step) continue;
        const FinerDirections block{leaves[i].x * side, leaves[i].y * side, side, step};
        const auto same = [&](const FinerDirections& b) {
            return b.x == block.x && b.y == block.y && b.side == block.side;
        };
        if (leaves[i].environment == 0 || std::none_of(blocks.begin(), blocks.end(), same)) blocks.push_back(block);
    }
    if (!blocks.empty()) traceFiner(in.scene, only, blocks, visibility, in.progress);
}

void LightProblem::learnTransport(const SolveInput& in, const EmitterDecision& emitters,
                                  const std::vector<uint8_t>& vertices) {
    if (!visibility.bits.empty()) {
        addVisibility(in.scene, vertices, visibility, in.progress);
        traceFinerLeaves(in, lighting.leaves, vertices);
    }
    NearFieldOptions options;
    options.seed = in.options.seed;
    options.only = &vertices;
    addNearField(in.scene, emitters.clusters, options, nearField, in.progress);
    for (size_t v = 0; v < known.size(); ++v) known[v] |= vertices[v];
}

InfluenceMatrix LightProblem::rowsOf(const SolveInput& in, const EmitterDecision& emitters,
                                     const std::vector<uint32_t>& vertices) {
    std::vector<uint8_t> unknown(known.size(), 0);
    bool any = false;
    for (uint32_t v : vertices) any |= unknown[v] = !known[v];
    if (any) learnTransport(in, emitters, unknown);
    if (!environmentBlack || !visibility.bits.empty())
        return lambertInfluence(in.scene, visibility, nearField, lighting.leaves, vertices, in.progress);
    // Nothing comes from afar: columns of zeros.
    InfluenceMatrix matrix;
    const size_t leaves = lighting.leaves.size();
    matrix.rows = vertices.size();
    matrix.columns = leaves + nearField.emitters;
    matrix.values.assign(matrix.rows * matrix.columns, 0.0f);
    for (size_t r = 0; r < matrix.rows; ++r)
        for (size_t e = 0; e < nearField.emitters; ++e) matrix.row(r)[leaves + e] = nearField.at(vertices[r], e);
    return matrix;
}

InfluenceMatrix LightProblem::rowsOf(const SolveInput& in, const EmitterDecision& emitters,
                                     const MatteObservations& matte) {
    if (matte.states() == 1) return rowsOf(in, emitters, matte.vertices);
    // A vertex has one row, of which each state takes its part.
    std::vector<uint32_t> vertices = matte.vertices;
    std::sort(vertices.begin(), vertices.end());
    vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
    const InfluenceMatrix all = rowsOf(in, emitters, vertices);
    InfluenceMatrix rows;
    rows.rows = matte.vertices.size();
    rows.columns = all.columns;
    rows.values.resize(rows.rows * rows.columns);
    for (size_t s = 0; s < matte.states(); ++s) {
        size_t at = 0;
        for (size_t i = matte.beginOf(s); i < matte.endOf(s); ++i) {
            while (vertices[at] != matte.vertices[i]) ++at;
            std::copy(all.row(at), all.row(at) + all.columns, rows.row(i));
            emitters.dim(rows.row(i), lighting.leaves, s);
        }
    }
    return rows;
}

std::vector<Rgb> LightProblem::directAt(const SolveInput& in, const EmitterDecision& emitters,
                                        const std::vector<uint32_t>& vertices, size_t state) {
    const Lighting shining = emitters.inState(lighting, state);
    std::vector<Rgb> out;
    constexpr size_t block = 2048;  // rows are as wide as there are leaves: not all at once
    for (size_t begin = 0; begin < vertices.size(); begin += block) {
        const std::vector<uint32_t> some(vertices.begin() + ptrdiff_t(begin),
                                         vertices.begin() + ptrdiff_t(std::min(vertices.size(), begin + block)));
        const InfluenceMatrix rows = rowsOf(in, emitters, some);
        for (size_t i = 0; i < some.size(); ++i) out.push_back(lightOfRow(rows.row(i), shining));
    }
    return out;
}

void LightProblem::anchor(const SolveInput& in, const EmitterDecision& emitters) {
    anchors = lightAnchors(in.samples, emitters.clusters, lighting.leaves);
    if (backgroundRefuted) anchors.leaves.assign(anchors.leaves.size(), LeafAnchor{});
    for (const auto& probe : in.options.probes) {
        anchors.probes.push_back(probeAnchor(*probe, lighting.leaves, in.options.probedEnvironment));
        if (backgroundRefuted) anchors.probes.back().gainSigma = 0;
    }
    // Inside a leaf that the background covers, its brightness is known in detail.
    const DirectionGrid& grid = in.samples.backgroundGrid;
    const size_t cells = size_t(grid.cells());
    leafShape.clear();
    for (size_t environment = 0; environment < lighting.leaves.environments(); ++environment) {
        std::vector<float> shape(cells, 1.0f);
        const std::vector<uint32_t> leafOf = lighting.leaves.leafOfCells(grid, environment);
        for (size_t cell = 0; cell < cells; ++cell) {
            const LeafAnchor& a = anchors.leaves[leafOf[cell]];
            const float mean = luminance(a.radiance);
            const size_t seen = environment * cells + cell;
            if (a.coverage < 0.95f || a.clipped || in.samples.backgroundPixels[seen] < 4 || !(mean > 0)) continue;
            shape[cell] = luminance(in.samples.background[seen]) / mean;
        }
        if (!anchors.probes.empty() && environment == in.options.probedEnvironment)
            shapeByProbes(in.options.probes, anchors, grid, leafOf, shape);
        leafShape.insert(leafShape.end(), shape.begin(), shape.end());
    }
}

bool LightProblem::refuteBackground(const SolveInput& in, const EmitterDecision& emitters,
                                    const MatteObservations& matte) {
    if (backgroundRefuted || environmentBlack || matte.vertices.empty() || !tiesScale(anchors, prior.darkness))
        return false;
    LightAnchors others = anchors;
    others.leaves.clear();
    if (tiesScale(others, prior.darkness)) return false;
    std::vector<float> albedo;
    for (size_t i = 0; i < influence.rows; ++i)
        if (const float lit = luminance(lightOfRow(influence.row(i), lighting)); lit > 0)
            albedo.push_back(luminance(matte.radiance[i]) / lit);
    if (albedo.empty()) return false;
    std::nth_element(albedo.begin(), albedo.begin() + ptrdiff_t(albedo.size() / 2), albedo.end());
    const float middle = albedo[albedo.size() / 2];
    if (middle > 0.04f && middle < 1.3f) return false;
    logInfo("the background seen would need surfaces of albedo {:.2g}: it is not what lights the scene", middle);
    backgroundRefuted = true;
    anchor(in, emitters);
    for (Rgb& l : lighting.leafRadiance) l *= middle / 0.5f;
    return true;
}

void LightProblem::split(const SolveInput& in, const EmitterDecision& emitters, const MatteObservations& observed,
                         const std::vector<uint32_t>& chosen) {
    Lighting finer = lighting;
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
    wider.rows = influence.rows;
    wider.columns = finer.leaves.size() + emitters.surfaces.size();
    wider.values.assign(wider.rows * wider.columns, 0.0f);
    for (size_t r = 0; r < wider.rows; ++r) {
        const float* row = influence.row(r);
        std::copy(row, row + before, wider.row(r));
        std::copy(row + before, row + influence.columns, wider.row(r) + finer.leaves.size());
    }
    if (visibility.step > 1) traceFinerLeaves(in, finer.leaves, known);
    lambertInfluenceOfLeaves(in.scene, visibility, finer.leaves, observed.vertices, changed, wider, in.progress);
    for (size_t r = 0; !in.samples.environmentOfState.empty() && r < wider.rows; ++r)
        for (const size_t state = observed.stateOf(r); const uint32_t k : changed)
            if (!finer.leaves.shines(k, state)) wider.row(r)[k] = 0;
    influence = std::move(wider);
    lighting = std::move(finer);
    anchor(in, emitters);
    // What the background shows in detail is known at once.
    for (const uint32_t k : changed)
        if (const LeafAnchor& a = anchors.leaves[k]; a.coverage > 0.95f && !a.clipped)
            lighting.leafRadiance[k] = a.radiance;
}

void LightProblem::keepForCut(const SolveInput& in) {
    if (in.progress.hasBudget()) beforeCut = {lighting, influence, information};
}

void LightProblem::takeBackUnfitted(const SolveInput& in, const EmitterDecision& emitters) {
    const bool fitted = size_t(information.all.rows()) == 3 * influence.columns && !information.all.isZero(0);
    if (environmentBlack || fitted || lighting.leaves.size() == beforeCut.lighting.leaves.size() ||
        lighting.emitterRadiance.size() != beforeCut.lighting.emitterRadiance.size())
        return;
    lighting = std::move(beforeCut.lighting);
    influence = std::move(beforeCut.influence);
    information = std::move(beforeCut.information);
    anchor(in, emitters);
}

}  // namespace relamp
