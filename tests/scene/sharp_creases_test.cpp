// Creases that a reconstruction rounds.
#include "scene/sharp_creases.h"

#include <gtest/gtest.h>

#include "base/random.h"
#include "support/shapes.h"

namespace relamp {
namespace {

constexpr float edge = 0.01f;

/// A sheet of 60 x 40 edges, bent by `bend`, with as much noise along its normals.
template <class Bend>
Mesh bentSheet(const Bend& bend, float noise) {
    Mesh mesh = test::sheet({-0.3f, 0, 0}, {0.6f, 0, 0}, {0, 0.4f, 0}, 60, 40);
    for (size_t v = 0; v < mesh.vertexCount(); ++v) {
        Vec3& p = mesh.positions[v];
        p.x += 0.3f * edge * std::sin(41 * p.y);  // no row of vertices lies along the crease
        p = bend(p.x, p.y);
    }
    const std::vector<Vec3> normals = vertexNormalsFromFaces(mesh);
    for (size_t v = 0; v < mesh.vertexCount(); ++v)
        mesh.positions[v] += noise * (2 * unitFloat(mixBits(v)) - 1) * normals[v];
    mesh.normals = vertexNormalsFromFaces(mesh);
    return mesh;
}

std::vector<CreaseVertex> creasesOf(const Mesh& mesh) {
    return sharpCreases(test::sceneOf(mesh), mesh.positions, {}, std::vector<uint8_t>(mesh.vertexCount(), 0));
}

/// Up to the edge, then down: the planes z = 0 and x = 0 meet at 90 degrees in an arc of this radius.
Vec3 roundedEdge(float along, float y, float radius) {
    const float half = 0.25f * pi * radius;  // of the arc's length
    if (along < -half) return {along + half - radius, y, 0};
    if (along > half) return {0, y, -(along - half) - radius};
    const float turn = (along + half) / radius;
    return {-radius + radius * std::sin(turn), y, radius * std::cos(turn) - radius};
}

TEST(SharpCreases, ARoundedEdgeBecomesTwoPlanes) {
    Mesh mesh = bentSheet([](float x, float y) { return roundedEdge(x, y, 2 * edge); }, 0.02f * edge);
    const std::vector<CreaseVertex> found = creasesOf(mesh);
    ASSERT_GT(found.size(), 100u);
    size_t atCrease = 0;
    for (const CreaseVertex& c : found) {
        const bool top = c.normal.z > 0.7f;
        EXPECT_GT(top ? c.normal.z : c.normal.x, 0.999f);
        EXPECT_LT(std::abs(top ? c.position.z : c.position.x), 0.1f * edge);
        EXPECT_LT(glm::distance(c.position, mesh.positions[c.vertex]), 2.5f * edge);
        const float beside = top ? -c.position.x : -c.position.z;
        EXPECT_GT(beside, -0.1f * edge) << "on its side of the crease";
        atCrease += beside < 0.15f * edge;
        mesh.positions[c.vertex] = c.position;
    }
    EXPECT_GT(atCrease, 41u) << "both sides end at the crease: more than one vertex a row";
    float between = 0, area = 0;  // triangles that face neither way
    for (size_t t = 0; t < mesh.triangles.size(); ++t) {
        const Vec3 n = mesh.faceNormal(t);
        EXPECT_TRUE(n.x + n.z > 0 || mesh.triangleArea(t) < 0.05f * edge * edge) << "none but slivers is turned over";
        area += mesh.triangleArea(t);
        if (n.z < 0.98f && n.x < 0.98f) between += mesh.triangleArea(t);
    }
    EXPECT_LT(between, 0.01f * area);
}

/// The sheet wraps around a part of a drum.
void expectCircle(float radius) {
    const auto bend = [&](float x, float y) {
        const Vec3 profile = roundedEdge(x, y, 2 * edge);
        const float out = radius + profile.x, angle = y / radius;
        return Vec3(out * std::cos(angle), out * std::sin(angle), profile.z);
    };
    // Towards its axis the top's triangles get narrow.
    const Mesh mesh = bentSheet(bend, 0);
    const std::vector<CreaseVertex> found = creasesOf(mesh);
    ASSERT_GT(found.size(), 60u);
    size_t asked = 0, stays = 0;  // where moving would turn a triangle over
    for (const CreaseVertex& c : found) {
        const float out = std::hypot(c.position.x, c.position.y),
                    along = radius * std::atan2(c.position.y, c.position.x);
        if (along < 6 * edge || along > 0.4f - 6 * edge) continue;  // what is around is cut off
        ++asked;
        const bool top = c.normal.z > 0.7f;
        EXPECT_GT(top ? c.normal.z : (c.normal.x * c.position.x + c.normal.y * c.position.y) / out, 0.992f);
        if (c.position == mesh.positions[c.vertex]) ++stays;
        else EXPECT_LT(std::abs(top ? c.position.z : out - radius), 0.1f * edge);
    }
    EXPECT_LT(20 * stays, asked);
}

TEST(SharpCreases, ACreaseBetweenTheTopAndTheSideOfADrumIsACircle) {
    expectCircle(0.25f);
    expectCircle(0.12f);  // its side turns by 57 degrees within reach
}

TEST(SharpCreases, WhatHasNoTwoFlatSidesStays) {
    EXPECT_TRUE(creasesOf(bentSheet([](float x, float y) { return Vec3(x, y, 0); }, 0.05f * edge)).empty()) << "flat";
    EXPECT_TRUE(creasesOf(test::ball({0, 0, 0}, 0.1f, 24, 48)).empty());
    EXPECT_TRUE(creasesOf(bentSheet([](float x, float y) { return roundedEdge(x, y, 12 * edge); }, 0)).empty())
        << "a wide round is no crease";
    const auto blade = [](float x, float y) { return Vec3(-std::abs(x), y, x > 0 ? -0.5f * edge : 0); };
    EXPECT_TRUE(creasesOf(bentSheet(blade, 0)).empty()) << "back to back";
    const auto bumps = [](float x, float y) {
        return Vec3(x, y, 1.5f * edge * std::sin(x / edge) * std::sin(y / edge));
    };
    EXPECT_TRUE(creasesOf(bentSheet(bumps, 0)).empty());
}

TEST(SharpCreases, ASharpEdgeStaysSharpAndItsVerticesKeepTheirSides) {
    Mesh mesh = bentSheet([](float x, float y) { return roundedEdge(x, y, 2 * edge); }, 0.02f * edge);
    const Scene scene = test::sceneOf(mesh);
    const std::vector<uint8_t> noLight(mesh.vertexCount(), 0);
    std::vector<Vec3> sides(mesh.vertexCount(), Vec3(0));
    for (const CreaseVertex& c : sharpCreases(scene, mesh.positions, {}, noLight)) {
        mesh.positions[c.vertex] = c.position;
        sides[c.vertex] = c.normal;
    }
    size_t atCrease = 0;
    for (const CreaseVertex& c : sharpCreases(scene, mesh.positions, sides, noLight)) {
        if (sides[c.vertex] != Vec3(0)) { EXPECT_GT(glm::dot(c.normal, sides[c.vertex]), 0.999f); }
        EXPECT_LT(glm::distance(c.position, mesh.positions[c.vertex]), 0.5f * edge);
        if (c.middle == c.normal) continue;
        ++atCrease;
        EXPECT_NEAR(c.middle.x, c.middle.z, 0.05f) << "half way between the sides";
    }
    EXPECT_GT(atCrease, 41u);
}

TEST(SharpCreases, LightsStay) {
    const Mesh mesh = bentSheet([](float x, float y) { return roundedEdge(x, y, 2 * edge); }, 0);
    std::vector<uint8_t> light(mesh.vertexCount(), 0);
    for (size_t v = 0; v < light.size(); ++v) light[v] = mesh.positions[v].y < 0.2f;
    for (const CreaseVertex& c : sharpCreases(test::sceneOf(mesh), mesh.positions, {}, light))
        EXPECT_EQ(light[c.vertex], 0);
}

}  // namespace
}  // namespace relamp
