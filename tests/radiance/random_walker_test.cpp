// Labels that spread over a graph.
#include "radiance/random_walker.h"

#include <gtest/gtest.h>

#include <limits>

namespace relamp {
namespace {

constexpr float fixed = std::numeric_limits<float>::infinity();

/// Vertices 0 ... n - 1, each joined to the next.
VertexGraph chain(uint32_t n) {
    VertexGraph graph;
    for (uint32_t v = 0; v < n; ++v) {
        graph.start.push_back(uint32_t(graph.to.size()));
        if (v > 0) graph.to.push_back(v - 1);
        if (v + 1 < n) graph.to.push_back(v + 1);
    }
    graph.start.push_back(uint32_t(graph.to.size()));
    return graph;
}

/// The edge between v and v + 1 has this weight, all others 1.
std::vector<float> weightsWith(const VertexGraph& graph, uint32_t v, float weight) {
    std::vector<float> weights(graph.to.size(), 1);
    for (uint32_t a = 0; a + 1 < graph.start.size(); ++a)
        for (uint32_t e = graph.start[a]; e < graph.start[a + 1]; ++e)
            if (std::min(a, graph.to[e]) == v && std::max(a, graph.to[e]) == v + 1) weights[e] = weight;
    return weights;
}

/// Labels of a chain of 11 whose ends are 0 and 1.
std::vector<float> between(uint32_t edge, float weight) {
    const VertexGraph graph = chain(11);
    std::vector<LabelPrior> priors(11);
    priors[0] = {0, fixed};
    priors[10] = {1, fixed};
    return randomWalkerLabels(graph, weightsWith(graph, edge, weight), priors);
}

TEST(RandomWalker, BetweenTwoFixedEndsLabelsAreLinear) {
    const std::vector<float> labels = between(0, 1);
    for (size_t v = 0; v < 11; ++v) EXPECT_NEAR(labels[v], 0.1f * float(v), 1e-4f);
}

TEST(RandomWalker, TheBorderGoesToTheWeakestEdge) {
    const std::vector<float> labels = between(7, 0.01f);
    // Ten edges, one of resistance 100: the others take 1 of 109 each.
    EXPECT_NEAR(labels[7], 7 / 109.0f, 1e-4f);
    EXPECT_NEAR(labels[8], 107 / 109.0f, 1e-4f);
}

TEST(RandomWalker, PriorsPullByTheirWeight) {
    const VertexGraph graph = chain(2);
    const std::vector<float> labels = randomWalkerLabels(graph, {1, 1}, {{0, fixed}, {1, 3}});
    EXPECT_NEAR(labels[1], 0.75f, 1e-5f);
    const std::vector<float> alone = randomWalkerLabels(chain(1), {}, {{1, 0}});
    EXPECT_EQ(alone[0], 0.5f) << "nothing is known";
}

}  // namespace
}  // namespace relamp
