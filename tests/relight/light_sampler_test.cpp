#include "relight/light_sampler.h"

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

TEST(EmitterSampler, IntegratesItsAreaWhateverThePointItServes) {
    // A closed box of two triangles a face; points are drawn for a point beside it, and 1 / density must average to the
    // area of what can be seen from there.
    EmitterSurface s;
    const auto face = [&](Vec3 a, Vec3 b, Vec3 c) {
        s.corners.push_back({a, b, c});
        s.centres.push_back((a + b + c) / 3.0f);
        const Vec3 n = glm::cross(b - a, c - a);
        s.normals.push_back(glm::normalize(n));
        s.areas.push_back(glm::length(n) / 2);
        s.radii.push_back(0.8f);
        s.cumulativeArea.push_back((s.cumulativeArea.empty() ? 0 : s.cumulativeArea.back()) + s.areas.back());
    };
    face({0, 0, 0}, {1, 0, 0}, {1, 1, 0});  // faces +z
    face({0, 0, 0}, {1, 1, 0}, {0, 1, 0});
    face({0, 0, -0.1f}, {1, 1, -0.1f}, {1, 0, -0.1f});  // faces -z
    face({0, 0, -0.1f}, {0, 1, -0.1f}, {1, 1, -0.1f});
    s.centroid = {0.5f, 0.5f, -0.05f};
    s.radius = 0.8f;
    const EmitterSampler sampler(s);
    EmitterSampler::Proposal proposal;
    ASSERT_TRUE(sampler.prepare({0.5f, 0.5f, 3}, {0, 0, -1}, proposal));
    double sum = 0;
    constexpr int n = 20000;
    for (int i = 0; i < n; ++i) {
        float density = 0;
        size_t triangle = 0;
        const Vec3 p =
            sampler.sample(proposal, {(float(i) + 0.5f) / n, r2Point(uint32_t(i), {0.1f, 0.2f}).y}, density, triangle);
        EXPECT_FLOAT_EQ(density, sampler.areaDensity(proposal, triangle));
        if (s.normals[triangle].z > 0) {
            sum += 1 / density / n;
            EXPECT_NEAR(p.z, 0, 1e-6);
        }
    }
    EXPECT_NEAR(sum, 1, 0.01);
}

TEST(EmitterSampler, GivesNothingBehindTheHorizon) {
    EmitterSurface s;
    s.corners.push_back({Vec3(0, 0, -5), Vec3(1, 0, -5), Vec3(0, 1, -5)});
    s.centres.push_back({0.33f, 0.33f, -5});
    s.normals.push_back({0, 0, 1});
    s.areas.push_back(0.5f);
    s.radii.push_back(0.8f);
    s.cumulativeArea.push_back(0.5f);
    s.radius = 0.8f;
    const EmitterSampler sampler(s);
    EmitterSampler::Proposal proposal;
    EXPECT_FALSE(sampler.prepare({0, 0, 0}, {0, 0, 1}, proposal));
}

}  // namespace
}  // namespace relamp
