#include "image/environment_map.h"

#include <gtest/gtest.h>

#include "base/error.h"
#include "image/image_io.h"
#include "support/temporary_folder.h"

namespace relamp {
namespace {

DVec3 energyOf(const std::vector<Rgb>& cells, const DirectionGrid& grid) {
    DVec3 sum(0);
    for (const Rgb& c : cells) sum += DVec3(c) * double(grid.cellSolidAngle());
    return sum;
}

TEST(EnvironmentMap, CentreIsPlusXRightIsMinusYTopIsPlusZ) {
    EXPECT_LT(glm::distance(directionFromLatLong({0.5f, 0.5f}), Vec3(1, 0, 0)), 1e-6f);
    EXPECT_LT(glm::distance(directionFromLatLong({0.75f, 0.5f}), Vec3(0, -1, 0)), 1e-6f);
    EXPECT_LT(glm::distance(directionFromLatLong({0.25f, 0.5f}), Vec3(0, 1, 0)), 1e-6f);
    EXPECT_LT(glm::distance(directionFromLatLong({0.0f, 0.5f}), Vec3(-1, 0, 0)), 1e-6f);
    EXPECT_LT(glm::distance(directionFromLatLong({0.5f, 0.0f}), Vec3(0, 0, 1)), 1e-6f);
    EXPECT_LT(glm::distance(latLongFromDirection({0, -1, 0}), Vec2(0.75f, 0.5f)), 1e-6f);
    EXPECT_NEAR(latLongFromDirection({0.6f, 0, 0.8f}).y, 0.5f - std::asin(0.8f) / pi, 1e-6);
    EXPECT_NEAR(latLongFromDirection({0, 0, 1}).y, 0, 1e-6);
}

TEST(EnvironmentMap, DirectionsGoThereAndBack) {
    for (float v = 0.05f; v < 1; v += 0.1f)
        for (float u = 0.02f; u < 1; u += 0.07f)
            EXPECT_LT(glm::distance(latLongFromDirection(directionFromLatLong({u, v})), Vec2(u, v)), 1e-5f);
}

TEST(EnvironmentMap, ConstantMapIsThatConstantInEveryCell) {
    for (const int side : {4, 32, 64})
        for (const int height : {8, 64}) {
            const DirectionGrid grid{side};
            for (const Rgb& c : integrateOverCells(Image(2 * height, height, Rgb(0.5f, 1, 2)), grid))
                ASSERT_LT(glm::distance(c, Rgb(0.5f, 1, 2)), 1e-4f) << side << " " << height;
        }
}

TEST(EnvironmentMap, OneBrightTexelKeepsItsEnergy) {
    const DirectionGrid grid{32};
    for (const auto& [x, y] : {std::pair(10, 3), std::pair(64, 31), std::pair(127, 63), std::pair(0, 0)}) {
        for (const float background : {0.0f, 0.3f}) {
            Image map(128, 64, Rgb(background));
            map.at(x, y) += Rgb(1e5f, 5e4f, 1e4f);
            const double top = piD * (0.5 - y / 64.0), bottom = piD * (0.5 - (y + 1) / 64.0);
            const double solidAngle = 2 * piD / 128 * (std::sin(top) - std::sin(bottom));
            const DVec3 wanted = DVec3(1e5, 5e4, 1e4) * solidAngle + DVec3(4 * piD * double(background));
            const DVec3 found = energyOf(integrateOverCells(map, grid), grid);
            EXPECT_LT(glm::distance(found, wanted) / glm::length(wanted), 1e-3) << x << " " << y;
        }
    }
}

TEST(EnvironmentMap, BrightTexelLandsInTheCellOfItsDirection) {
    const DirectionGrid grid{8};
    Image map(256, 128);
    map.at(190, 40) = Rgb(1);
    const auto cells = integrateOverCells(map, grid);
    const size_t wanted = size_t(grid.cellOf(directionFromLatLong({190.5f / 256, 40.5f / 128})));
    EXPECT_EQ(
        size_t(std::max_element(cells.begin(), cells.end(), [](const Rgb& a, const Rgb& b) { return a.x < b.x; }) -
               cells.begin()),
        wanted);
}

/// What integrateOverCells promises, by cellOf for each of the 4 x 4 components of a texel.
std::vector<Rgb> byEveryDirection(const Image& map, const DirectionGrid& grid) {
    std::vector<DVec3> energy(size_t(grid.cells()), DVec3(0));
    std::vector<double> angle(energy.size(), 0);
    std::vector<Rgb> darkest(energy.size(), Rgb(1e9f)), cells(energy.size());
    for (int row = 0; row < 4 * map.height; ++row) {
        const int y = row / 4;
        const double top = std::sin(piD * (0.5 - double(y) / map.height)),
                     bottom = std::sin(piD * (0.5 - double(y + 1) / map.height)),
                     z = top + (bottom - top) * (row % 4 + 0.5) / 4, r = std::sqrt(1 - z * z),
                     component = 2 * piD / map.width * (top - bottom) / 16;
        for (int column = 0; column < 4 * map.width; ++column) {
            const double azimuth = (0.5 - (column + 0.5) / (4 * map.width)) * 2 * piD;
            const Vec3 direction(float(r * std::cos(azimuth)), float(r * std::sin(azimuth)), float(z));
            const size_t cell = size_t(grid.cellOf(direction));
            const Rgb& radiance = map.at(column / 4, y);
            energy[cell] += DVec3(radiance) * component;
            angle[cell] += component;
            darkest[cell] = glm::min(darkest[cell], radiance);
        }
    }
    const double cellAngle = 4 * piD / grid.cells();
    for (size_t i = 0; i < cells.size(); ++i)
        if (angle[i] > 0) cells[i] = Rgb((energy[i] - DVec3(darkest[i]) * (angle[i] - cellAngle)) / cellAngle);
    return cells;
}

TEST(EnvironmentMap, ComponentsLandWhereTheGridPutsTheirDirections) {
    // Radiance differs by texel: a component in the wrong cell changes it by far more than rounding.
    Image map(512, 256);
    for (size_t i = 0; i < map.pixels.size(); ++i)
        map.pixels[i] = Rgb(1 + float(i * 2654435761u % 1009), 1, float(i % 7));
    for (const Mat3& axes : {Mat3(1), Mat3(0, 0.6f, 0.8f, 0, -0.8f, 0.6f, 1, 0, 0)}) {
        const DirectionGrid grid{64, axes};
        const std::vector<Rgb> found = integrateOverCells(map, grid), wanted = byEveryDirection(map, grid);
        for (size_t i = 0; i < wanted.size(); ++i) ASSERT_LT(glm::distance(found[i], wanted[i]), 1e-3f) << i;
    }
}

TEST(EnvironmentMap, LookupIsBilinearAndWrapsInLongitude) {
    Image map(8, 4);
    map.at(0, 2) = Rgb(1);
    map.at(7, 2) = Rgb(3);
    EXPECT_NEAR(environmentRadiance(map, directionFromLatLong({0.5f / 8, 2.5f / 4})).x, 1, 1e-5);
    EXPECT_NEAR(environmentRadiance(map, directionFromLatLong({0.0f, 2.5f / 4})).x, 2, 1e-5);
    EXPECT_NEAR(environmentRadiance(map, directionFromLatLong({0.5f / 8, 2.0f / 4})).x, 0.5f, 1e-5);
    EXPECT_EQ(environmentRadiance(Image(8, 4, Rgb(2)), {0, 0, 1}), Rgb(2));
}

TEST(EnvironmentMap, CellsComeBackThroughAnImage) {
    const DirectionGrid grid{8};
    std::vector<Rgb> cells(64);
    for (size_t i = 0; i < cells.size(); ++i) cells[i] = Rgb(float(i), 1, 64 - float(i));
    const auto back = integrateOverCells(latLongFromCells(cells, grid, 512), grid);
    for (size_t i = 0; i < cells.size(); ++i) EXPECT_LT(glm::distance(back[i], cells[i]), 3.0f) << i;
    EXPECT_LT(glm::distance(energyOf(back, grid), energyOf(cells, grid)) / glm::length(energyOf(cells, grid)), 5e-3);
}

TEST(EnvironmentMap, YawTurnsCounterClockwiseSeenFromAbove) {
    Image map(16, 8);
    map.at(8, 4) = Rgb(1);  // just right of +X
    const Image turned = yawed(map, 90);
    EXPECT_EQ(turned.at(4, 4), Rgb(1));  // towards +Y: left
    EXPECT_EQ(turned.at(8, 4), Rgb(0));
    EXPECT_EQ(yawed(map, 360).at(8, 4), Rgb(1));
    EXPECT_EQ(yawed(map, -90).at(12, 4), Rgb(1));
    const Image half = yawed(map, 360.0f / 32);
    EXPECT_NEAR(half.at(7, 4).x, 0.5, 1e-5);
    EXPECT_NEAR(half.at(8, 4).x, 0.5, 1e-5);
}

TEST(EnvironmentMap, FilesMustBeTwiceAsWideAsHigh) {
    test::TemporaryFolder folder;
    writeImage(folder / "square.exr", Image(8, 8, Rgb(1)));
    EXPECT_EQ(test::messageOf([&] { readEnvironment(folder / "square.exr"); }),
              (folder / "square.exr").string() +
                  ": is 8 x 8 pixels, expected a latitude-longitude image twice as wide as high");
    Image map(8, 4, Rgb(1));
    map.at(3, 1) = Rgb(-5, 0, 0);
    map.at(4, 1) = Rgb(2e6f);
    writeImage(folder / "map.exr", map);
    const Image back = readEnvironment(folder / "map.exr");
    EXPECT_EQ(back.at(3, 1), Rgb(0));
    EXPECT_EQ(back.at(4, 1), Rgb(2e6f));
    EXPECT_TRUE(back.usable.empty());
}

}  // namespace
}  // namespace relamp
