#include "transport/visibility.h"

#include <gtest/gtest.h>

#include "base/parallel.h"
#include "support/shapes.h"
#include "support/stopping.h"
#include "wavelet/haar.h"

namespace relamp {
namespace {

Visibility visibilityOf(const Scene& scene, int side) {
    Progress progress;
    return computeVisibility(scene, {side}, progress);
}

Mesh clutter() {
    Mesh mesh = test::sheet({-2, -2, 0}, {4, 0, 0}, {0, 4, 0}, 6, 6);
    test::append(mesh, test::box({-0.4f, -0.6f, 0.05f}, {0.3f, 0.2f, 0.9f}));
    test::append(mesh, test::ball({1, 0.7f, 0.5f}, 0.35f, 6, 9));
    return mesh;
}

TEST(Visibility, BitsAreThoseOfBruteForceRays) {
    const Scene scene = test::sceneOf(clutter());
    const Visibility visibility = visibilityOf(scene, 16);
    size_t seen = 0, blocked = 0;
    for (uint32_t v = 0; v < scene.mesh.vertexCount(); ++v) {
        const Vec3 normal = scene.mesh.normals[v], origin = rayOrigin(scene, scene.mesh.positions[v], normal);
        for (int c = 0; c < visibility.grid.cells(); ++c) {
            const Vec3 d = visibility.grid.direction(c);
            const bool above = glm::dot(d, normal) > 0,
                       open = above && !test::blockedByBruteForce(scene.mesh, origin, d);
            ASSERT_EQ(visibility.sees(v, c), open) << "vertex " << v << " cell " << c;
            seen += open;
            blocked += above && !open;
        }
    }
    EXPECT_GT(seen, 1000u);
    EXPECT_GT(blocked, 1000u) << "nothing was in the way: the test tells nothing";
}

TEST(Visibility, PassesGiveTheBitsOfOneGo) {
    const Scene scene = test::sceneOf(clutter());
    Progress progress;
    for (const bool agreeing : {true, false}) {
        Visibility passes = computeVisibility(scene, {64, nullptr, 4}, progress);
        size_t outgoing = 0;
        for (const int step : {2, 1}) {
            outgoing += refineVisibility(scene, scene.referenced, step, agreeing, passes, progress);
            EXPECT_EQ(passes.bits, computeVisibility(scene, {64, nullptr, step, agreeing}, progress).bits)
                << "step " << step;
        }
        EXPECT_EQ(passes.step, 1);
        EXPECT_EQ(refineVisibility(scene, scene.referenced, 1, agreeing, passes, progress), 0u)
            << "rays were sent again";
        Visibility anew = passes;
        const size_t whole = addVisibility(scene, scene.referenced, anew, progress);
        EXPECT_LT(outgoing, whole);
        EXPECT_EQ(anew.bits, passes.bits);
    }
}

TEST(Visibility, SomeDirectionsCanBeTracedFiner) {
    const Scene scene = test::sceneOf(clutter());
    Progress progress;
    const Visibility coarse = computeVisibility(scene, {64, nullptr, 4}, progress),
                     half = computeVisibility(scene, {64, nullptr, 2}, progress), full = visibilityOf(scene, 64);
    Visibility some = coarse;
    const std::vector<FinerDirections> blocks{{16, 8, 8, 1}, {40, 40, 4, 2}};
    EXPECT_GT(traceFiner(scene, scene.referenced, blocks, some, progress), 0u);
    size_t gained = 0;
    for (uint32_t v = 0; v < scene.mesh.vertexCount(); ++v)
        for (int c = 0; c < some.grid.cells(); ++c) {
            const int x = c % 64, y = c / 64;
            const Visibility& expected = x >= 16 && x < 24 && y >= 8 && y < 16    ? full
                                         : x >= 40 && x < 44 && y >= 40 && y < 44 ? half
                                                                                  : coarse;
            ASSERT_EQ(some.sees(v, c), expected.sees(v, c)) << "vertex " << v << " cell " << x << " " << y;
            gained += some.sees(v, c) != coarse.sees(v, c);
        }
    EXPECT_GT(gained, 0u) << "no edge lies in the blocks: the test tells nothing";
    refineVisibility(scene, scene.referenced, 1, true, some, progress);
    EXPECT_EQ(some.bits, full.bits);
}

TEST(Visibility, RaysAmidAgreeingOnesAreLeftOutWithoutLoss) {
    const Scene scene = test::sceneOf(clutter());
    Progress progress;
    const Visibility full = visibilityOf(scene, 64),
                     fewer = computeVisibility(scene, {64, nullptr, 1, false}, progress);
    double wrong = 0, seen = 0;
    for (uint32_t v = 0; v < scene.mesh.vertexCount(); ++v)
        for (int c = 0; c < full.grid.cells(); ++c) {
            wrong += full.sees(v, c) != fewer.sees(v, c);
            seen += full.sees(v, c);
        }
    EXPECT_LT(wrong, 0.003 * seen);
    Visibility a = full, b = fewer;
    const size_t all = addVisibility(scene, scene.referenced, a, progress),
                 some = addVisibility(scene, scene.referenced, b, progress);
    EXPECT_LT(some, all * 7 / 10);
    // The coarsest lattice keeps every block's answer in all its cells above the horizon.
    const Visibility coarse = computeVisibility(scene, {64, nullptr, 4}, progress);
    for (uint32_t v = 0; v < scene.mesh.vertexCount(); ++v)
        for (int c = 0; c < full.grid.cells(); ++c)
            if (coarse.sees(v, c)) { ASSERT_GT(glm::dot(full.grid.direction(c), scene.mesh.normals[v]), 0); }
}

TEST(Visibility, OfAnOpenPlaneIsTheUpperHemisphere) {
    const Scene scene = test::sceneOf(test::sheet({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, 2, 2));
    for (const int side : {8, 64}) {
        const Visibility visibility = visibilityOf(scene, side);
        for (uint32_t v = 0; v < scene.mesh.vertexCount(); ++v)
            for (int c = 0; c < visibility.grid.cells(); ++c)
                ASSERT_EQ(visibility.sees(v, c), visibility.grid.direction(c).z > 0);
    }
}

TEST(Visibility, OfUnreferencedVerticesIsEmpty) {
    Mesh mesh = test::sheet({-1, -1, 0}, {2, 0, 0}, {0, 2, 0});
    mesh.positions.push_back({0, 0, 3});
    mesh.normals.push_back({0, 0, 1});
    const Visibility visibility = visibilityOf(test::sceneOf(mesh), 8);
    for (int c = 0; c < 64; ++c) EXPECT_FALSE(visibility.sees(4, c));
}

TEST(Visibility, CoefficientsHoldTheFunctionAndTheirEnergyItsSquare) {
    const Scene scene = test::sceneOf(clutter());
    const Visibility visibility = visibilityOf(scene, 32);
    for (const uint32_t v : {0u, 24u, 50u}) {
        std::vector<float> cells(size_t(visibility.grid.cells()));
        scatter(visibilityCoefs(visibility, v, 1), cells);
        haarInverse(cells, 32);
        for (int c = 0; c < visibility.grid.cells(); ++c)
            ASSERT_NEAR(cells[size_t(c)] / std::sqrt(visibility.grid.cellSolidAngle()), visibility.sees(v, c), 1e-4);
        scatter(visibilityCosineCoefs(scene, visibility, v, 1), cells);
        double energy = 0, expected = 0;
        for (const float value : cells) energy += double(value) * value;
        for (int c = 0; c < visibility.grid.cells(); ++c) {
            const double cosine = glm::dot(scene.mesh.normals[v], visibility.grid.direction(c));
            if (visibility.sees(v, c)) expected += cosine * cosine * visibility.grid.cellSolidAngle();
        }
        EXPECT_NEAR(energy, expected, 1e-4 * expected + 1e-9);
    }
}

TEST(Visibility, HasTheSameBitsOnOneAndManyThreads) {
    const Scene scene = test::sceneOf(clutter());
    const auto bits = [&](int threads) {
        const ThreadLimit limit(threads);
        return visibilityOf(scene, 32).bits;
    };
    EXPECT_EQ(bits(1), bits(4));
    const auto fewer = [&](int threads) {
        const ThreadLimit limit(threads);
        Progress progress;
        return computeVisibility(scene, {64, nullptr, 1, false}, progress).bits;
    };
    EXPECT_EQ(fewer(1), fewer(4));
}

TEST(Visibility, StopsHalfWayWhenAsked) {
    Mesh mesh = test::sheet({-2, -2, 0}, {4, 0, 0}, {0, 4, 0}, 150, 150);
    test::append(mesh, test::ball({0, 0, 1}, 0.5f, 20, 30));
    const Scene scene = test::sceneOf(mesh);
    test::expectStopsHalfWay([&](Progress& progress) { computeVisibility(scene, {128}, progress); });
}

}  // namespace
}  // namespace relamp
