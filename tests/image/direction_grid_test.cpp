#include "image/direction_grid.h"

#include <gtest/gtest.h>

#include "base/random.h"

namespace relamp {
namespace {

Vec3 randomDirection(uint64_t n) {
    const Vec2 u = randomShift(5, n, 2);
    const float z = 2 * u.x - 1, r = std::sqrt(std::max(0.0f, 1 - z * z));
    return {r * std::cos(2 * pi * u.y), r * std::sin(2 * pi * u.y), z};
}

TEST(DirectionGrid, EveryCellHoldsTheSameFractionOfUniformDirections) {
    const DirectionGrid grid{8};
    const int samples = 1000000;
    std::vector<int> count(size_t(grid.cells()), 0);
    for (int n = 0; n < samples; ++n) ++count[size_t(grid.cellOf(randomDirection(uint64_t(n))))];
    const double expected = double(samples) / grid.cells();
    for (const int found : count) EXPECT_NEAR(found, expected, 5 * std::sqrt(expected));
}

TEST(DirectionGrid, LiesAlongItsAxes) {
    const Mat3 axes = frameAround(glm::normalize(Vec3(1, 2, -1)));
    const DirectionGrid turned{16, axes}, world{16};
    for (int c = 0; c < world.cells(); ++c) {
        EXPECT_EQ(turned.cellOf(turned.direction(c)), c);
        EXPECT_LT(glm::distance(turned.direction(c), axes * world.direction(c)), 1e-6f);
    }
}

/// Light from `cells` on a surface that faces `normal`, up to a constant.
double lightOn(const std::vector<Rgb>& cells, const DirectionGrid& grid, const Vec3& normal) {
    double sum = 0;
    for (int c = 0; c < grid.cells(); ++c)
        sum += double(cells[size_t(c)].x) * std::max(0.0f, glm::dot(grid.direction(c), normal));
    return sum;
}

TEST(DirectionGrid, CellsTurnedToOtherAxesGiveTheSameLight) {
    const DirectionGrid own{128, frameAround(glm::normalize(Vec3(1, 2, -1)))}, world{128};
    std::vector<Rgb> cells(size_t(own.cells()));
    for (int c = 0; c < own.cells(); ++c)
        cells[size_t(c)] = Rgb(0.2f + std::abs(std::sin(0.3f * float(c % 128)) * float(c / 128) / 128));
    const std::vector<Rgb> constant(cells.size(), Rgb(0.7f, 0.2f, 3));
    for (const Rgb& c : turnedCells(constant, own, world)) EXPECT_LT(glm::distance(c, constant[0]), 1e-5f);
    cells[4711] = Rgb(30000);  // a sun: half of all light
    const std::vector<Rgb> turned = turnedCells(cells, own, world);
    double before = 0, after = 0;
    for (size_t c = 0; c < cells.size(); ++c) before += cells[c].x, after += turned[c].x;
    EXPECT_NEAR(after / before, 1, 2e-4);
    const double most = lightOn(cells, own, own.direction(4711));
    for (uint64_t n = 0; n < 20; ++n) {
        const Vec3 normal = randomDirection(n);
        EXPECT_NEAR(lightOn(turned, world, normal) / most, lightOn(cells, own, normal) / most, 2e-3)
            << n;  // the sun moves by less than a cell
    }
}

TEST(DirectionGrid, MapStretchesAreaByFourPiEverywhere) {
    const float step = 1e-3f;
    int checked = 0;
    for (uint64_t n = 0; n < 5000; ++n) {
        const Vec2 p = randomShift(9, n, 0);
        const float u = std::abs(2 * p.x - 1), v = std::abs(2 * p.y - 1);
        const float toCrease = std::min({u, v, std::abs(1 - u - v), 1 - u, 1 - v});
        if (toCrease < 6 * step || 2 - u - v < 0.05f || u + v < 0.05f)
            continue;  // differences across a crease or pole mean nothing
        const Vec3 alongU = (squareToSphere(p + Vec2(step, 0)) - squareToSphere(p - Vec2(step, 0))) / (2 * step);
        const Vec3 alongV = (squareToSphere(p + Vec2(0, step)) - squareToSphere(p - Vec2(0, step))) / (2 * step);
        ASSERT_NEAR(glm::length(glm::cross(alongU, alongV)), 4 * pi, 0.01f * 4 * pi) << p.x << " " << p.y;
        ++checked;
    }
    EXPECT_GT(checked, 4000);
}

TEST(DirectionGrid, CellsTogetherCoverTheSphere) {
    const DirectionGrid grid{32};
    EXPECT_FLOAT_EQ(grid.cellSolidAngle() * float(grid.cells()), 4 * pi);
}

TEST(DirectionGrid, CentreOfEveryCellLiesInThatCell) {
    for (const int side : {1, 2, 8, 64, 256}) {
        const DirectionGrid grid{side};
        for (int cell = 0; cell < grid.cells(); ++cell) {
            const Vec3 d = grid.direction(cell);
            ASSERT_EQ(grid.cellOf(d), cell) << "side " << side;
            ASSERT_NEAR(glm::length(d), 1, 1e-6);
        }
    }
}

TEST(DirectionGrid, DirectionsSurviveTheRoundTripThroughTheSquare) {
    for (uint64_t n = 0; n < 100000; ++n) {
        const Vec3 d = randomDirection(n), back = squareToSphere(sphereToSquare(d));
        ASSERT_LT(glm::length(back - d), 1e-5f) << d.x << " " << d.y << " " << d.z;
    }
}

TEST(DirectionGrid, PointsOfTheSquareSurviveTheRoundTripThroughTheSphere) {
    for (uint64_t n = 0; n < 100000; ++n) {
        const Vec2 p = randomShift(6, n, 0), back = sphereToSquare(squareToSphere(p));
        // Near a pole a whole float step of z is a visible distance on the square: sqrt(2^-24) / 2.
        ASSERT_LT(glm::length(back - p), 2.5e-4f) << p.x << " " << p.y;
    }
}

TEST(DirectionGrid, AxesLieWhereTheMapPutsThem) {
    const auto expect = [](const Vec3& d, const Vec2& p) {
        const Vec2 found = sphereToSquare(d);
        EXPECT_NEAR(found.x, p.x, 1e-6) << d.x << " " << d.y << " " << d.z;
        EXPECT_NEAR(found.y, p.y, 1e-6) << d.x << " " << d.y << " " << d.z;
        EXPECT_LT(glm::length(squareToSphere(p) - d), 1e-6f) << d.x << " " << d.y << " " << d.z;
    };
    expect({0, 0, 1}, {0.5f, 0.5f});
    expect({0, 0, -1}, {1, 1});
    expect({1, 0, 0}, {1, 0.5f});
    expect({-1, 0, 0}, {0, 0.5f});
    expect({0, 1, 0}, {0.5f, 1});
    expect({0, -1, 0}, {0.5f, 0});
}

TEST(DirectionGrid, AllFourCornersAreTheLowerPole) {
    for (const Vec2& corner : {Vec2(0, 0), Vec2(1, 0), Vec2(0, 1), Vec2(1, 1)})
        EXPECT_LT(glm::length(squareToSphere(corner) - Vec3(0, 0, -1)), 1e-6f);
}

TEST(DirectionGrid, UpperHemisphereIsTheInnerDiamond) {
    for (uint64_t n = 0; n < 10000; ++n) {
        const Vec2 p = randomShift(8, n, 0);
        const float inside = 1 - std::abs(2 * p.x - 1) - std::abs(2 * p.y - 1);
        if (std::abs(inside) < 1e-5f) continue;
        ASSERT_EQ(squareToSphere(p).z > 0, inside > 0);
    }
}

TEST(DirectionGrid, ConstantEnvironmentOfRadianceOneGivesIrradiancePi) {
    const DirectionGrid grid{64};
    for (const Vec3& normal : {Vec3(0, 0, 1), Vec3(0, 0, -1), Vec3(1, 0, 0), Vec3(0, -1, 0),
                               glm::normalize(Vec3(1, 2, 3)), glm::normalize(Vec3(-3, 1, -0.5f))}) {
        // Cell centres alone, then 4 x 4 points a cell: cells cut by the horizon leave an error that falls with the
        // square.
        for (const int fine : {1, 4}) {
            double irradiance = 0;
            for (int cell = 0; cell < grid.cells(); ++cell)
                for (int k = 0; k < fine * fine; ++k) {
                    const Vec2 inside((float(k % fine) + 0.5f) / float(fine), (float(k / fine) + 0.5f) / float(fine));
                    irradiance += double(std::max(0.0f, glm::dot(grid.direction(cell, inside), normal)));
                }
            irradiance *= double(grid.cellSolidAngle()) / (fine * fine);
            EXPECT_NEAR(irradiance / piD, 1, fine == 1 ? 1e-3 : 1e-4) << normal.x << " " << normal.y << " " << normal.z;
        }
    }
}

}  // namespace
}  // namespace relamp
