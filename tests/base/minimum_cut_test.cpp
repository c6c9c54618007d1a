#include "base/minimum_cut.h"

#include <gtest/gtest.h>

#include "base/random.h"

namespace relamp {
namespace {

double energyOf(const std::vector<uint8_t>& label, const std::vector<double>& gain, const std::vector<CutEdge>& edges) {
    double sum = 0;
    for (size_t i = 0; i < gain.size(); ++i) sum -= label[i] ? gain[i] : 0;
    for (const CutEdge& e : edges) sum += label[e.a] != label[e.b] ? e.cost : 0;
    return sum;
}

TEST(MinimumCut, IsTheBestOfAllLabels) {
    constexpr uint32_t nodes = 10;
    for (uint64_t seed = 0; seed < 40; ++seed) {
        uint64_t bits = seed;
        const auto draw = [&] { return double(unitFloat(bits = mixBits(bits))); };
        std::vector<double> gain(nodes);
        for (double& g : gain) g = 4 * draw() - 2;
        std::vector<CutEdge> edges;
        for (int k = 0; k < 18; ++k)
            edges.push_back({uint32_t(draw() * nodes), uint32_t(draw() * nodes), 1.5 * draw()});
        double best = 0;
        for (uint32_t mask = 0; mask < 1u << nodes; ++mask) {
            std::vector<uint8_t> label(nodes);
            for (uint32_t i = 0; i < nodes; ++i) label[i] = mask >> i & 1;
            best = std::min(best, energyOf(label, gain, edges));
        }
        EXPECT_NEAR(energyOf(minimumCut(gain, edges), gain, edges), best, 0.01) << seed;
    }
}

TEST(MinimumCut, DearBordersKeepNeighboursTogether) {
    const std::vector<double> gain{5, -1, 0, -1, -9};
    const auto chain = [](double cost) {
        return std::vector<CutEdge>{{0, 1, cost}, {1, 2, cost}, {2, 3, 0.5}, {3, 4, cost}};
    };
    EXPECT_EQ(minimumCut(gain, chain(3)), (std::vector<uint8_t>{1, 1, 1, 0, 0}));
    EXPECT_EQ(minimumCut(gain, chain(0.1)), (std::vector<uint8_t>{1, 0, 0, 0, 0}));
    EXPECT_TRUE(minimumCut({}, {}).empty());
}

}  // namespace
}  // namespace relamp
