#include "transport/transport_store.h"

#include <gtest/gtest.h>

#include "base/parallel.h"
#include "image/direction_grid.h"

namespace relamp {
namespace {

constexpr int storedSide = 16;

/// Cosine lobes about different normals, half of them behind a wall.
std::vector<float> blockCells() {
    const DirectionGrid grid{storedSide};
    std::vector<float> cells(transportLanes * size_t(grid.cells()));
    for (size_t lane = 0; lane < transportLanes; ++lane) {
        const Vec3 normal = glm::normalize(Vec3(0.1f * float(lane), 0.3f, 1));
        for (int c = 0; c < grid.cells(); ++c) {
            const Vec3 d = grid.direction(c);
            const bool blocked = lane % 2 && d.x > 0.2f;
            cells[lane * size_t(grid.cells()) + size_t(c)] =
                blocked ? 0.0f : std::max(0.0f, glm::dot(normal, d)) * grid.cellSolidAngle() / pi;
        }
    }
    return cells;
}

std::vector<float> gradient() {
    const DirectionGrid grid{storedSide};
    std::vector<float> cells(size_t(grid.cells()));
    for (int c = 0; c < grid.cells(); ++c)
        cells[size_t(c)] = 1 + 5 * std::max(0.0f, grid.direction(c).y) + (c == 77 ? 30.0f : 0.0f);
    return cells;
}

float directSum(const std::vector<float>& transport, size_t lane, const std::vector<float>& light) {
    float sum = 0;
    for (size_t c = 0; c < light.size(); ++c) sum += transport[lane * light.size() + c] * light[c];
    return sum;
}

std::array<std::vector<float>, 3> coefsOf(const std::vector<float>& cells) {
    const std::vector<float> coefs = environmentHaar(cells, storedSide);
    return {coefs, coefs, coefs};
}

TEST(TransportStore, ConstantLightIsExactHoweverFewTermsAreKept) {
    const std::vector<float> cells = blockCells();
    std::vector<float> work = cells;
    const TransportStore store({packTransport(work, TermTests(storedSide, {}), 0.5f)});
    std::vector<Rgb> out(transportLanes);
    const std::vector<float> constant(size_t(storedSide * storedSide), 2.0f);
    store.apply(coefsOf(constant), out);
    for (size_t lane = 0; lane < transportLanes; ++lane)
        EXPECT_NEAR(out[lane].y, directSum(cells, lane, constant), 2e-4f);
}

TEST(TransportStore, TestEnvironmentsAreMetWithinTheErrorAskedFor) {
    const std::vector<float> cells = blockCells(), light = gradient();
    size_t previous = 0;
    for (const float error : {0.05f, 0.01f, 0.002f}) {
        std::vector<float> work = cells;
        const TransportStore store({packTransport(work, TermTests(storedSide, {light}), error)});
        std::vector<Rgb> out(transportLanes);
        store.apply(coefsOf(light), out);
        for (size_t lane = 0; lane < transportLanes; ++lane) {
            const float expected = directSum(cells, lane, light);
            EXPECT_NEAR(out[lane].x, expected, (error + 5e-4f) * expected);
        }
        EXPECT_GT(store.terms(), previous) << "finer takes more";
        previous = store.terms();
    }
}

TEST(TransportStore, AllTermsGiveTheCellsBack) {
    const std::vector<float> cells = blockCells();
    std::vector<float> work = cells;
    const TransportStore store({packTransport(work, TermTests(storedSide, {gradient()}), 0)});
    for (const int sun : {5, 100, 200}) {
        std::vector<float> light(size_t(storedSide * storedSide), 0.0f);
        light[size_t(sun)] = 100;
        std::vector<Rgb> out(transportLanes);
        store.apply(coefsOf(light), out);
        for (size_t lane = 0; lane < transportLanes; ++lane)
            EXPECT_NEAR(out[lane].z, directSum(cells, lane, light), 2e-3f);
    }
}

TEST(TransportStore, AReplacedBlockLeavesTheOthersAlone) {
    std::vector<float> cells = blockCells(), other = blockCells(), third = blockCells();
    for (float& c : other) c *= 0.5f;
    const TermTests tests(storedSide, {gradient()});
    const TransportBlock a = packTransport(cells, tests, 0.01f), b = packTransport(other, tests, 0.02f);
    TransportStore store({a, a, a}), expected({a, b, a});
    store.replace({{1u, b}});
    std::vector<Rgb> out(3 * transportLanes), wanted(3 * transportLanes);
    store.apply(coefsOf(gradient()), out);
    expected.apply(coefsOf(gradient()), wanted);
    EXPECT_EQ(out, wanted);
    EXPECT_EQ(store.bytes(), expected.bytes());
}

TEST(TransportStore, GivesTheSameBitsOnAnyNumberOfThreads) {
    std::vector<float> cells = blockCells();
    const TransportStore store(
        std::vector<TransportBlock>(200, packTransport(cells, TermTests(storedSide, {}), 0.01f)));
    std::vector<Rgb> one(200 * transportLanes), many(200 * transportLanes);
    {
        const ThreadLimit limit(1);
        store.apply(coefsOf(gradient()), one);
    }
    store.apply(coefsOf(gradient()), many);
    EXPECT_EQ(one, many);
}

}  // namespace
}  // namespace relamp
