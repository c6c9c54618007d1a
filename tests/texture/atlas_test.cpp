#include "texture/atlas.h"

#include <gtest/gtest.h>

#include "base/error.h"
#include "support/shapes.h"

namespace relamp {
namespace {

Atlas laidOut(const Mesh& mesh, float density, const AtlasOptions& options = {}) {
    Progress progress;
    return layOut(mesh, std::vector<float>(mesh.triangles.size(), density), options, progress);
}

/// Texels whose centres two triangles cover.
size_t sharedTexels(const Atlas& atlas) {
    std::vector<uint8_t> taken(size_t(atlas.width) * size_t(atlas.height), 0);
    size_t shared = 0;
    const auto cross = [](const Vec2& a, const Vec2& b) { return a.x * b.y - a.y * b.x; };
    for (const auto& p : atlas.corners) {
        if (p[0].x < 0) continue;
        const float area = cross(p[1] - p[0], p[2] - p[0]);
        for (int y = 0; y < atlas.height; ++y)
            for (int x = 0; x < atlas.width; ++x) {
                const Vec2 c(float(x) + 0.5f, float(y) + 0.5f);
                bool inside = area > 0;
                for (size_t k = 0; k < 3; ++k) inside &= cross(p[(k + 1) % 3] - p[k], c - p[k]) > 0.01f * area;
                if (inside) shared += taken[size_t(y) * size_t(atlas.width) + size_t(x)]++ > 0;
            }
    }
    return shared;
}

/// Smallest and largest ratio of an edge's length in texels to what the density asks for.
std::pair<float, float> stretch(const Mesh& mesh, const Atlas& atlas, float density) {
    std::pair<float, float> range{1e30f, 0};
    for (size_t t = 0; t < mesh.triangles.size(); ++t)
        for (size_t k = 0; k < 3; ++k) {
            const size_t n = (k + 1) % 3;
            const float wanted =
                density * glm::length(mesh.positions[mesh.triangles[t][n]] - mesh.positions[mesh.triangles[t][k]]);
            const float found = glm::length(atlas.corners[t][n] - atlas.corners[t][k]) / wanted;
            range = {std::min(range.first, found), std::max(range.second, found)};
        }
    return range;
}

TEST(Atlas, OfASheetIsOneChartOfItsOwnShape) {
    const Mesh mesh = test::sheet({-1, -1, 0}, {2, 0, 0}, {0, 1, 0}, 6, 3);
    const Atlas atlas = laidOut(mesh, 20);
    EXPECT_EQ(atlas.charts, 1u);
    EXPECT_FLOAT_EQ(atlas.scale, 1);
    const auto [least, most] = stretch(mesh, atlas, 20);
    EXPECT_NEAR(least, 1, 1e-3);
    EXPECT_NEAR(most, 1, 1e-3);
    EXPECT_EQ(sharedTexels(atlas), 0u);
}

TEST(Atlas, OfABallHasFewChartsWithoutOverlap) {
    const Mesh mesh = test::ball({0, 0, 0}, 1, 24, 48);
    const Atlas atlas = laidOut(mesh, 30);
    EXPECT_LT(atlas.charts, 40u);
    EXPECT_GT(atlas.charts, 3u);
    EXPECT_EQ(sharedTexels(atlas), 0u);
    const auto [least, most] = stretch(mesh, atlas, 30);
    EXPECT_GT(least, 0.3f);  // edges that run down the slope of a chart that is turned by up to 50 degrees
    EXPECT_LT(most, 1.001f);
    for (const auto& corners : atlas.corners)
        for (const Vec2& p : corners) {
            EXPECT_GE(p.x, 2);
            EXPECT_LE(p.x, float(atlas.width - 2));
            EXPECT_GE(p.y, 2);
            EXPECT_LE(p.y, float(atlas.height - 2));
        }
}

/// A ramp that winds twice about an axis, one turn over the other: its triangles face alike and are connected.
Mesh windingRamp(int steps, float height) {
    Mesh mesh;
    for (int i = 0; i <= steps; ++i) {
        const float part = float(i) / float(steps), turn = 4 * pi * part;
        for (const float r : {1.0f, 2.0f})
            mesh.positions.push_back({r * std::cos(turn), r * std::sin(turn), height * part});
    }
    for (uint32_t i = 0; i < uint32_t(steps); ++i) {
        mesh.triangles.push_back({2 * i, 2 * i + 1, 2 * i + 3});
        mesh.triangles.push_back({2 * i, 2 * i + 3, 2 * i + 2});
    }
    mesh.normals = vertexNormalsFromFaces(mesh);
    return mesh;
}

TEST(Atlas, WhatLiesOverItselfIsSplit) {
    const Atlas atlas = laidOut(windingRamp(96, 0.5f), 12);
    EXPECT_GE(atlas.charts, 2u);
    EXPECT_EQ(sharedTexels(atlas), 0u);
}

/// Triangles a quarter of a texel wide hold hardly any centre; still no layer lies within a texel of another one.
TEST(Atlas, LayersOfTrianglesSmallerThanTexelsAreParted) {
    constexpr float density = 8;
    const Mesh mesh = windingRamp(384, 4);
    const Atlas atlas = laidOut(mesh, density);
    const auto middle = [](const auto& corners) { return (corners[0] + corners[1] + corners[2]) / 3.0f; };
    std::vector<Vec2> places;
    std::vector<float> heights;
    for (size_t t = 0; t < mesh.triangles.size(); ++t) {
        places.push_back(middle(atlas.corners[t]));
        const Triangle& c = mesh.triangles[t];
        heights.push_back((mesh.positions[c[0]].z + mesh.positions[c[1]].z + mesh.positions[c[2]].z) / 3);
    }
    size_t near = 0;
    for (size_t a = 0; a < places.size(); ++a)
        for (size_t b = 0; b < a; ++b)
            near += glm::length(places[a] - places[b]) < 1 && std::abs(heights[a] - heights[b]) > 1;
    EXPECT_EQ(near, 0u);
}

TEST(Atlas, StaysWithinItsSideByCoarserTexels) {
    const Mesh mesh = test::ball({0, 0, 0}, 1, 12, 24);
    AtlasOptions options;
    options.mostSide = 128;
    const Atlas atlas = laidOut(mesh, 1e4f, options);
    EXPECT_LE(atlas.width, 128);
    EXPECT_LE(atlas.height, 128);
    EXPECT_LT(atlas.scale, 0.01f);
    EXPECT_EQ(sharedTexels(atlas), 0u);
}

TEST(Atlas, TrianglesWithoutADensityHaveNoPlace) {
    const Mesh mesh = test::sheet({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, 2, 2);
    std::vector<float> density(mesh.triangles.size(), 50);
    density[3] = 0;
    Progress progress;
    const Atlas atlas = layOut(mesh, density, {}, progress);
    EXPECT_LT(atlas.corners[3][0].x, 0);
    EXPECT_GE(atlas.corners[2][0].x, 0);
    const Atlas nothing = layOut(mesh, std::vector<float>(mesh.triangles.size(), 0.0f), {}, progress);
    EXPECT_EQ(nothing.width, 0);
}

TEST(Atlas, MoreChartsThanTexelsIsAnError) {
    Mesh mesh;
    for (int i = 0; i < 200; ++i) test::append(mesh, test::sheet({float(i), 0, 0}, {0.5f, 0, 0}, {0, 0.5f, 0}));
    AtlasOptions options;
    options.mostSide = 32;
    EXPECT_THROW(laidOut(mesh, 10, options), Error);
}

}  // namespace
}  // namespace relamp
