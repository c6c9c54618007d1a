// A lamp shade of which a reconstruction has a part.
#include "radiance/round_sheets.h"

#include <gtest/gtest.h>

#include "radiance/back_sides.h"
#include "radiance/gather.h"
#include "radiance/whole_shade.h"
#include "support/estimates.h"
#include "support/point_photograph.h"

namespace relamp {
namespace {

constexpr double low = -0.1, high = 0.12;

RevolutionSurface shadeOf() {
    RevolutionSurface s;
    s.centre = {0.1, 0, 0.5};
    s.axis = glm::normalize(DVec3(-0.5, 0.2, 0.8));
    s.across = glm::normalize(glm::cross(s.axis, DVec3(1, 0, 0)));
    s.radius = 0.16;
    s.slope = -0.5;
    return s;
}

/// Where a height and a turn (0 to 1) of the shade have surface.
using Has = std::function<bool(double height, double turn)>;

/// One side of the shade, moved out by `off` metres; turned inside out where that is negative.
Mesh sideOf(double off, const Has& has) {
    const RevolutionSurface s = shadeOf();
    constexpr int rows = 30, columns = 120;
    Mesh mesh;
    for (int row = 0; row <= rows; ++row)
        for (int column = 0; column < columns; ++column) {
            const double turn = 2 * piD * column / columns;
            mesh.positions.push_back(Vec3(s.at(low + (high - low) * row / rows, turn) + off * s.normal(turn)));
            mesh.normals.push_back(Vec3(s.normal(turn)) * (off < 0 ? -1.0f : 1.0f));
        }
    const auto at = [&](int y, int x) { return uint32_t(y * columns + x % columns); };
    for (int row = 0; row < rows; ++row)
        for (int column = 0; column < columns; ++column) {
            if (!has(low + (high - low) * (row + 0.5) / rows, (column + 0.5) / columns)) continue;
            for (Triangle t : {Triangle{at(row, column), at(row, column + 1), at(row + 1, column + 1)},
                               Triangle{at(row, column), at(row + 1, column + 1), at(row + 1, column)}}) {
                if (off < 0) std::swap(t[1], t[2]);
                mesh.triangles.push_back(t);
            }
        }
    return mesh;
}

Mesh worldOf(const Has& outside, const Has& inside) {
    Mesh mesh = test::sheet({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, 100, 100);
    test::append(mesh, sideOf(0.001, outside));
    test::append(mesh, sideOf(-0.001, inside));
    return mesh;
}

bool all(double, double) { return true; }
bool none(double, double) { return false; }
bool gap(double height, double turn) { return height < 0.02 && turn > 0.2 && turn < 0.5; }
bool butGap(double height, double turn) { return !gap(height, turn); }

/// Photographs of one world, and a mesh of another.
struct Shaded {
    Capture capture;
    Scene scene;
    RadianceSamples samples;

    Shaded(const Mesh& photographed, const Mesh& mesh) {
        const Scene real = test::sceneOf(photographed);
        const RevolutionSurface s = shadeOf();
        capture.mesh = mesh;
        scene = test::sceneOf(mesh);
        for (int i = 0; i < 10; ++i) {
            const double turn = 2 * piD * i / 10;
            const Camera camera = test::cameraAt({1.5 * std::cos(turn), 1.5 * std::sin(turn), i % 2 ? 1.0 : 0.35},
                                                 {0, 0, 0.4}, 240, 180, 220);
            const auto shown = [&](const Hit& hit, const Vec3& p, const Vec3& d) {
                if (!hit) return Rgb(0.3f + 0.2f * std::sin(5 * d.x), 0.4f, 0.3f + 0.2f * std::sin(4 * d.y));
                if (p.z < 1e-3f) return Rgb(0.25f, 0.15f, 0.1f) * (1 + 0.3f * std::sin(25 * p.x + 9 * p.y));
                return s.distance(DVec3(p)) > 0 ? Rgb(0.02f, 0.08f, 0.02f) : Rgb(2, 1.8f, 1.5f);
            };
            capture.views.push_back(test::pointPhotograph(real, camera, shown));
        }
        Progress progress;
        samples = gatherRadiance(capture, scene, {}, progress);
    }
    float missing() const {
        Progress progress;
        float area = 0;
        for (const RoundSheet& sheet : roundSheets(scene, capture, samples, progress)) area += sheet.missing.area;
        return area;
    }
};

TEST(RoundSheets, AShadeIsCompletedWhereThePhotographsShowIt) {
    const Shaded world(worldOf(all, all), worldOf(butGap, butGap));
    Progress progress;
    const std::vector<RoundSheet> sheets = roundSheets(world.scene, world.capture, world.samples, progress);
    ASSERT_EQ(sheets.size(), 1u);
    const RevolutionSurface truth = shadeOf();
    const SurfacePatch& patch = sheets[0].missing;
    const double area = (0.02 - low) * 0.3 * 2 * piD * truth.radiusAt((0.02 + low) / 2) * std::sqrt(1.25);
    EXPECT_NEAR(patch.area, area, 0.15 * area);
    for (const Vec3& p : patch.positions) EXPECT_NEAR(truth.distance(DVec3(p)), 0, 0.003);
    // Half of it faces outwards, half inwards.
    size_t outwards = 0;
    Mesh mesh{patch.positions, {}, patch.triangles};
    for (size_t t = 0; t < mesh.triangles.size(); ++t)
        outwards +=
            glm::dot(DVec3(mesh.faceNormal(t)), truth.normalAt(DVec3(mesh.positions[mesh.triangles[t][0]]))) > 0;
    EXPECT_EQ(2 * outwards, mesh.triangles.size());
}

TEST(RoundSheets, NothingIsMissingFromAWholeShade) {
    EXPECT_EQ(Shaded(worldOf(all, all), worldOf(all, all)).missing(), 0);
}

TEST(RoundSheets, AGapThatPhotographsSeeThroughStays) {
    EXPECT_EQ(Shaded(worldOf(butGap, butGap), worldOf(butGap, butGap)).missing(), 0);
}

TEST(RoundSheets, APatchThatLeavesTheSurfaceInPartsIsNotAdded) {
    // Of the cone six tenths are there, as of a body that bulges about it, and of these the mesh lacks a piece.
    const auto part = [](double, double turn) { return turn < 0.6; };
    const auto partButGap = [&](double height, double turn) { return part(height, turn) && butGap(height, turn); };
    EXPECT_EQ(Shaded(worldOf(part, part), worldOf(partButGap, partButGap)).missing(), 0);
}

TEST(WholeShade, AnEvenSheetTakesThePlaceOfShreds) {
    // Cut crookedly at its wide end, and shreds of its inner side.
    const auto crooked = [](double height, double turn) { return height > low + 0.03 + 0.02 * std::sin(80 * turn); };
    Mesh mesh = sideOf(0, crooked);
    const size_t own = mesh.vertexCount(), wall = mesh.triangles.size();
    test::append(mesh, sideOf(-0.008, [](double height, double turn) {
                     return height < low + 0.04 && std::sin(60 * turn) > 0.7;
                 }));
    const Scene scene = test::sceneOf(mesh);
    const RevolutionSurface truth = shadeOf();
    const auto sheet = wholeShade(scene, own, {truth, low, high, {}}, {truth, low, 0, 0}, true);
    ASSERT_TRUE(sheet);
    double lowest = 1, highest = -1;
    for (const Vec3& p : sheet->positions) {
        EXPECT_NEAR(truth.distance(DVec3(p)), 0, 0.003);
        lowest = std::min(lowest, truth.height(DVec3(p)));
        highest = std::max(highest, truth.height(DVec3(p)));
    }
    EXPECT_NEAR(lowest, low, 0.002) << "to the rim";
    EXPECT_GT(highest, high - 0.04);
    // Outer and inner side, and a narrow rim that joins them.
    const Mesh whole{sheet->positions, {}, sheet->triangles};
    float outwards = 0, inwards = 0, rim = 0;
    for (size_t t = 0; t < whole.triangles.size(); ++t) {
        const double along =
            glm::dot(DVec3(whole.faceNormal(t)), truth.normalAt(DVec3(whole.positions[whole.triangles[t][0]])));
        (along > 0.9 ? outwards : along < -0.9 ? inwards : rim) += whole.triangleArea(t);
    }
    EXPECT_NEAR(outwards, inwards, 0.03f * outwards);
    EXPECT_LT(rim, 0.03f * outwards);
    EXPECT_GT(outwards, 0.1f);
    // All shreds go, and the wall but its uppermost rows.
    EXPECT_EQ(std::count_if(sheet->replaced.begin(), sheet->replaced.end(), [&](uint32_t t) { return t >= wall; }),
              std::ptrdiff_t(mesh.triangles.size() - wall));
    EXPECT_GT(sheet->replaced.size(), 0.8 * double(mesh.triangles.size()));
    // Of half a ring there is no whole sheet.
    const Scene half = test::sceneOf(sideOf(0, [](double, double turn) { return turn < 0.5; }));
    EXPECT_FALSE(wholeShade(half, half.mesh.vertexCount(), {truth, low, high, {}}, {truth, low, 0, 0}, true));
}

TEST(WholeShade, EndsAtTheEdgesOfItsRim) {
    const Mesh mesh = sideOf(0, all);
    const RevolutionSurface truth = shadeOf();
    const Scene scene = test::sceneOf(mesh);
    const double inner = truth.radiusAt(low) - 0.005, outer = inner + 0.002 * double(scene.diagonal);
    const auto sheet = wholeShade(scene, mesh.vertexCount(), {truth, low, high, {}}, {truth, low, inner, outer}, true);
    ASSERT_TRUE(sheet);
    size_t ofInner = 0, ofOuter = 0;
    for (const Vec3& p : sheet->positions) {
        const double height = truth.height(DVec3(p));
        if (std::abs(height - low) > 1e-5) continue;
        const double r = glm::length(DVec3(p) - truth.centre - height * truth.axis);
        ofInner += std::abs(r - inner) < 1e-5;
        ofOuter += std::abs(r - outer) < 1e-5;
        EXPECT_TRUE(std::abs(r - inner) < 1e-5 || std::abs(r - outer) < 1e-5) << r;
    }
    EXPECT_EQ(ofInner, ofOuter);
    EXPECT_GT(ofInner, 11u);
}

TEST(BackSides, AShadeOfOneSideGetsAnInnerOne) {
    const Shaded world(worldOf(all, all), worldOf(all, none));
    const SurfacePatch patch = backSides(world.scene, world.capture, world.samples, {});
    EXPECT_GT(patch.triangles.size(), 1000u);
    const RevolutionSurface truth = shadeOf();
    Mesh mesh{patch.positions, {}, patch.triangles};
    for (size_t t = 0; t < mesh.triangles.size(); ++t) {
        const DVec3 p(mesh.positions[mesh.triangles[t][0]]);
        EXPECT_LT(truth.distance(p), 0);
        EXPECT_LT(glm::dot(DVec3(mesh.faceNormal(t)), truth.normalAt(p)), 0);
    }
    const Shaded whole(worldOf(all, all), worldOf(all, all));
    EXPECT_LT(backSides(whole.scene, whole.capture, whole.samples, {}).area, 0.02f * patch.area) << "but at its rims";
}

TEST(BackSides, WhatALightShinesOnFromBehindHasAnInnerSide) {
    Shaded world(worldOf(all, all), worldOf(all, none));
    world.capture.views.clear();
    world.samples.geometry.clear();
    EXPECT_TRUE(backSides(world.scene, world.capture, world.samples, {}).triangles.empty());
    const RevolutionSurface s = shadeOf();
    const SurfacePatch lit = backSides(world.scene, world.capture, world.samples, {}, {{Vec3(s.centre), 0.03f}});
    EXPECT_EQ(lit.triangles.size(), sideOf(0, all).triangles.size()) << "all of the wall";
}

TEST(BackSides, WhatFillsAShadeLiesBeforeBacks) {
    Mesh mesh = worldOf(all, none);
    const RevolutionSurface s = shadeOf();
    // A skin over the wide end.
    Mesh skin;
    skin.positions.push_back(Vec3(s.centre + (low + 0.005) * s.axis));
    for (int k = 0; k < 60; ++k) {
        const Vec3 rim(s.at(low + 0.005, 2 * piD * k / 60));
        skin.positions.push_back(skin.positions[0] + 0.97f * (rim - skin.positions[0]));
    }
    for (uint32_t k = 0; k < 60; ++k) skin.triangles.push_back({0, 1 + (k + 1) % 60, 1 + k});
    skin.normals.assign(skin.positions.size(), Vec3(-s.axis));
    const std::vector<uint32_t> triangles = test::append(mesh, skin);
    const Shaded world(worldOf(all, all), mesh);
    const SeenBehind behind = seenBehind(world.scene, world.capture, world.samples, triangles);
    EXPECT_GT(behind.backs, 0.7f);
    EXPECT_GT(behind.backs + behind.fronts, 0.8f);
    const RoundSheet sheet{s, low, high, {}};
    const std::vector<uint8_t> nothing(mesh.vertexCount(), 0);
    EXPECT_EQ(withFilling(sheet, world.scene, nothing, {triangles[7]}), triangles) << "all of the skin, and no wall";
    EXPECT_EQ(withFilling(sheet, world.scene, nothing, {3}), std::vector<uint32_t>{3}) << "the floor is not in it";
}

TEST(RoundSheets, TheLargestAboutABallIsItsShade) {
    const RevolutionSurface s = shadeOf();
    const double quarter = low + 0.25 * (high - low);
    const std::vector<RoundSheet> sheets{{s, low, quarter, {}}, {s, low, high, {}}};
    const auto ballAt = [&](double height, double beside) {
        ProxyLight ball;
        ball.centre = s.centre + height * s.axis + beside * (s.at(low, 0) - s.at(low, piD));
        ball.radius = 0.01f;
        return ball;
    };
    EXPECT_EQ(sheetAbout(sheets, ballAt(low + 0.01, 0)), &sheets[1]);
    EXPECT_EQ(sheetAbout(sheets, ballAt(low + 0.01, 2)), nullptr) << "outside";
    EXPECT_EQ(sheetAbout(sheets, ballAt(high + 0.03, 0)), nullptr) << "above it";
    const std::vector<const RoundSheet*> about = sheetsAbout(sheets, {ballAt(low, 0), ballAt(high, 0), ballAt(low, 2)});
    EXPECT_EQ(about, std::vector<const RoundSheet*>{&sheets[1]}) << "once";
}

}  // namespace
}  // namespace relamp
