#include "solve/priors/anchors.h"

namespace relamp {

std::vector<Rgb> firstRadiance(const EmitterClusters& clusters) {
    std::vector<Rgb> radiance;
    for (const EmitterCluster& e : clusters.emitters) radiance.push_back(e.radiance);
    return radiance;
}

bool tiesScale(const LightAnchors& anchors, float darkness) {
    for (size_t e = 0; e < anchors.emitterRadiance.size(); ++e)
        if (!anchors.emitterClipped[e] || maxChannel(anchors.emitterRadiance[e]) > 0) return true;
    for (const ProbeAnchor& p : anchors.probes)
        if (p.gainSigma > 0) return true;
    // A surface that all of it lights from straight ahead sends at most this back; `darkness` is a thousandth of the
    // brightest surfaces.
    double light = 0;
    for (const LeafAnchor& a : anchors.leaves)
        if (a.seen() && !a.clipped) light += double(a.area * maxChannel(a.radiance)) / piD;
    constexpr double least = 3;
    return light > least * double(darkness);
}

LightAnchors lightAnchors(const RadianceSamples& samples, const EmitterClusters& clusters, const LightLeaves& leaves) {
    LightAnchors anchors;
    anchors.leaves.resize(leaves.size());
    std::vector<Rgb> sum(leaves.size(), Rgb(0));
    std::vector<float> area(leaves.size(), 0);
    const DirectionGrid& grid = samples.backgroundGrid;
    // A cell counts when pixels cover it, not when one touches its corner: sub-cells of a fine leaf share their cell's
    // mean.
    const int parts = std::max(1, (1 << LightLeaves::maxLevel) / grid.side);
    const DirectionGrid fine{grid.side * parts, grid.axes};
    const float fraction = fine.cellSolidAngle();
    for (size_t environment = 0; environment < leaves.environments(); ++environment) {
        const std::vector<uint32_t> leafOf = leaves.leafOfCells(fine, environment);
        for (int c = 0; c < grid.cells(); ++c) {
            const size_t seen = environment * size_t(grid.cells()) + size_t(c);
            if (samples.backgroundPixels[seen] < 4) continue;
            for (int k = 0; k < parts * parts; ++k) {
                const size_t leaf =
                    leafOf[size_t((c / grid.side * parts + k / parts) * fine.side + c % grid.side * parts + k % parts)];
                sum[leaf] += fraction * samples.background[seen];
                area[leaf] += fraction;
                if (samples.backgroundClipped[seen]) anchors.leaves[leaf].clipped = true;
            }
        }
    }
    for (size_t i = 0; i < leaves.size(); ++i) {
        if (area[i] <= 0) continue;
        anchors.leaves[i].radiance = sum[i] / area[i];
        anchors.leaves[i].area = area[i];
        anchors.leaves[i].coverage = std::min(1.0f, area[i] / leaves[i].solidAngle());
    }
    for (const EmitterCluster& e : clusters.emitters) {
        // Nothing was seen of an unobserved one: at least nothing.
        anchors.emitterRadiance.push_back(e.unobserved ? Rgb(0) : e.radiance);
        anchors.emitterSigma.push_back(std::max(e.radianceSigma, 3e-4f));
        anchors.emitterClipped.push_back(e.unobserved || e.evidence.clippedFraction > 0.5f);
    }
    return anchors;
}

}  // namespace relamp
