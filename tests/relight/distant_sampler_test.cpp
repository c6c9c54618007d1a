#include "relight/distant_sampler.h"

#include <gtest/gtest.h>

#include "base/random.h"

namespace relamp {
namespace {

TEST(DistantSampler, DrawsDirectionsInProportionToItsDensity) {
    const DirectionGrid grid{64};
    std::vector<Rgb> cells(size_t(grid.cells()), Rgb(0.2f));
    cells[size_t(grid.cellOf(glm::normalize(Vec3(0.3f, 0.2f, 0.9f))))] = Rgb(900);
    const DistantLight light(grid, cells);
    const DistantSampler sampler(light);
    DistantSampler::Proposal proposal;
    ASSERT_TRUE(sampler.prepare(Vec3(0, 0, 1), proposal));
    const DirectionGrid coarse{8};
    std::vector<double> drawn(size_t(coarse.cells()), 0), expected(drawn);
    constexpr int n = 200000;
    for (int i = 0; i < n; ++i)
        drawn[size_t(coarse.cellOf(
            sampler.sample(proposal, {(float(i) + 0.5f) / n, r2Point(uint32_t(i), {0.3f, 0.7f}).y})))] += 1.0 / n;
    for (int c = 0; c < grid.cells(); ++c)
        expected[size_t(coarse.cellOf(grid.direction(c)))] +=
            double(sampler.density(proposal, grid.direction(c))) * grid.cellSolidAngle();
    double total = 0;
    for (size_t c = 0; c < drawn.size(); ++c) {
        EXPECT_NEAR(drawn[c], expected[c], 0.01 * expected[c] + 2e-4) << c;
        total += expected[c];
    }
    EXPECT_NEAR(total, 1, 1e-3);
}

TEST(DistantSampler, CoversEveryDirectionThatCanLightTheSurface) {
    const DirectionGrid grid{64};
    const DistantLight light(grid, std::vector<Rgb>(size_t(grid.cells()), Rgb(1)));
    const DistantSampler sampler(light);
    DistantSampler::Proposal proposal;
    const Vec3 normal = glm::normalize(Vec3(0.4f, -0.7f, 0.2f));
    ASSERT_TRUE(sampler.prepare(normal, proposal));
    for (int c = 0; c < grid.cells(); ++c)
        if (glm::dot(grid.direction(c), normal) > 0) {
            EXPECT_GT(sampler.density(proposal, grid.direction(c)), 0) << c;
        }
}

}  // namespace
}  // namespace relamp
