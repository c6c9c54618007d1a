// Skirts: mesh beyond what was photographed.
#include "radiance/free_space.h"

#include <gtest/gtest.h>

#include "support/before_background.h"

namespace relamp {
namespace {

using test::even;
using test::fine;
using test::MeshBefore;
using test::mirror;
using test::pattern;
using test::Sky;
using test::Surface;
using test::wood;

Mesh sheetOf(float half) { return test::sheet({-half, -half, 0}, {2 * half, 0, 0}, {0, 2 * half, 0}, 60, 60); }

/// A table of two metres, and a mesh whose table is `wider` by that much on all sides.
struct Table : MeshBefore {
    Table(float wider, const Sky& sky, const Surface& surface, double focal = 150, int views = 8)
        : MeshBefore(sheetOf(1), sheetOf(1 + wider), sky, surface, focal, views) {}

    /// Largest coordinate of the triangle's middle.
    float extent(uint32_t t) const {
        const Vec3 middle = middleOf(t);
        return std::max(std::abs(middle.x), std::abs(middle.y));
    }
};

void expectTheSkirtTaken(const Table& table) {
    size_t outside = 0, taken = 0;
    for (uint32_t t = 0; t < table.scene.mesh.triangles.size(); ++t) outside += table.extent(t) > 1.1f;
    for (const uint32_t t : table.free) {
        EXPECT_GT(table.extent(t), 0.93f);
        taken += table.extent(t) > 1.1f;
    }
    EXPECT_GT(taken, outside * 9 / 10) << taken << " of " << outside;
}

TEST(FreeSpace, AnExactMeshHasNone) { EXPECT_TRUE(Table(0, pattern, wood).free.empty()); }

TEST(FreeSpace, ASkirtBeforeAPatternedBackgroundGoesAndTheTableStays) {
    const Table table(0.3f, pattern, wood);
    expectTheSkirtTaken(table);
}

TEST(FreeSpace, ASkirtGoesThoughFewPhotographsShowWhatLiesBehindIt) {
    const Table table(0.5f, fine, wood, 250);
    expectTheSkirtTaken(table);
}

TEST(FreeSpace, ASkirtGoesThatOnePhotographShows) {
    const Table table(0.5f, pattern, wood, 250, 3);
    expectTheSkirtTaken(table);
}

TEST(FreeSpace, ASkirtEndsAtTheEdgeThatPhotographsShow) {
    // Triangles are 4.3 cm wide, and those across the edge are either's.
    const Table table(0.3f, pattern, wood);
    std::vector<uint8_t> isFree(table.scene.mesh.triangles.size(), 0);
    for (const uint32_t t : table.free) isFree[t] = 1;
    size_t wrong = 0, beside = 0;
    for (uint32_t t = 0; t < isFree.size(); ++t) {
        const float extent = table.extent(t);
        if (std::abs(extent - 1) < 0.045f || std::abs(extent - 1) > 0.15f) continue;
        ++beside;
        wrong += isFree[t] != (extent > 1);
    }
    EXPECT_GT(beside, 500u);
    EXPECT_LT(wrong, beside / 50) << wrong << " of " << beside;
}

TEST(FreeSpace, BeforeAnEvenBackgroundNothingIsRefuted) { EXPECT_TRUE(Table(0.3f, even, wood).free.empty()); }

/// Pixels of a view that see no mesh, times a factor.
void dim(Table& table, size_t view, float factor) {
    Image& image = table.capture.views[view].image;
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x)
            if (table.samples.geometry[view].triangle[size_t(y) * 200 + size_t(x)] == Hit::none)
                image.at(x, y) *= factor;
}

TEST(FreeSpace, WhatOnePhotographShowsBeyondTheMeshIsNoBackground) {
    // Such as the outside of a wall, which the mesh lacks.
    for (const bool several : {false, true}) {
        Table table(0.3f, pattern, wood, 110, 5);  // each shows what its two neighbours show, and little more
        for (size_t i = 0; i < table.capture.views.size(); i += 2)
            if (several || i == 2) dim(table, i, 0.1f + 0.1f * float(i));
        Progress progress;
        const std::vector<uint8_t> noLight(table.scene.mesh.vertexCount(), 0);
        table.free = freeSpaceTriangles(table.scene, table.capture, table.samples, noLight, progress);
        if (several) EXPECT_TRUE(table.free.empty());
        else expectTheSkirtTaken(table);
    }
}

TEST(FreeSpace, ABoardThatGoesOnBeyondTheMeshIsNoBackground) {
    // The mesh ends before the board does: what is seen past it is near and shifts from view to view.
    const Sky board = [](const Vec3& d) { return d.z < -0.1f ? Rgb(0.3f) : pattern(d); };
    Table table(0.3f, board, wood);
    for (size_t i = 0; i < table.capture.views.size(); ++i) dim(table, i, 1 + 0.1f * float(i));
    Progress progress;
    const std::vector<uint8_t> noLight(table.scene.mesh.vertexCount(), 0);
    EXPECT_TRUE(freeSpaceTriangles(table.scene, table.capture, table.samples, noLight, progress).empty());
}

TEST(FreeSpace, AMirrorShowsOtherBackgroundThanThatBehindIt) { EXPECT_TRUE(Table(0, pattern, mirror).free.empty()); }

TEST(FreeSpace, ABubbleThatClosesALightGoesAndABallStays) {
    // Of the ball the upper part is there; it shines, or it does not and the ball hangs there as a whole.
    const Vec3 middle(0, 0, 1.2f);
    constexpr float radius = 0.3f, cut = 1.3f;
    for (const bool light : {true, false}) {
        const Mesh ball = test::ball(middle, radius, 24, 48);
        Mesh there = ball, real = sheetOf(1), mesh = sheetOf(1);
        if (light) std::erase_if(there.triangles, [&](const Triangle& t) { return there.positions[t[0]].z < cut; });
        const auto surface = [&](const Vec3& at, const Vec3& d) {
            if (at.z < 0.5f) return wood(at, d);
            return light ? Rgb(40) : Rgb(0.5f, 0.3f, 0.2f);
        };
        const auto shines = [&](const Vec3& at) { return light && at.z > cut; };
        test::append(real, there);
        test::append(mesh, ball);
        const MeshBefore lit(real, mesh, pattern, surface, 150, 8, shines);
        size_t bubble = 0, taken = 0;
        for (uint32_t t = 0; t < lit.scene.mesh.triangles.size(); ++t) {
            const float z = lit.middleOf(t).z;
            bubble += z > 0.5f && z < cut - 0.05f;
        }
        for (const uint32_t t : lit.free) {
            EXPECT_GT(lit.middleOf(t).z, 0.5f);
            EXPECT_LT(lit.middleOf(t).z, cut + 0.05f);
            ++taken;
        }
        if (light) EXPECT_GT(taken, bubble * 8 / 10) << taken << " of " << bubble;
        else EXPECT_EQ(taken, 0u);
    }
}

}  // namespace
}  // namespace relamp
