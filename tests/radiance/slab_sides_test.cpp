// A table of which a reconstruction has the top, cut crookedly.
#include "radiance/slab_sides.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "base/random.h"
#include "radiance/gather.h"
#include "support/estimates.h"

namespace relamp {
namespace {

constexpr float halfX = 0.6f, halfY = 0.4f, thickness = 0.04f;

/// A sheet at height 0 whose triangles end where `in` does, to within a centimetre.
template <class In>
Mesh top(const In& in) {
    Mesh mesh = test::sheet({-0.75f, -0.55f, 0}, {1.5f, 0, 0}, {0, 1.1f, 0}, 150, 110);
    size_t number = 0;
    std::erase_if(mesh.triangles, [&](const Triangle& t) {
        const Vec3 p = (mesh.positions[t[0]] + mesh.positions[t[1]] + mesh.positions[t[2]]) / 3.0f;
        return !in(p, 0.02f * (unitFloat(mixBits(number++)) - 0.5f));
    });
    return mesh;
}

Mesh rectangularTop() {
    return top([](const Vec3& p, float crooked) {
        return std::abs(p.x) < halfX + crooked && std::abs(p.y) < halfY + crooked;
    });
}

/// What eight photographs of `real` make of `mesh`.
SlabSides sidesOf(const Mesh& real, const Mesh& mesh) {
    const Scene world = test::sceneOf(real), scene = test::sceneOf(mesh);
    Capture capture;
    capture.mesh = mesh;
    for (int i = 0; i < 8; ++i) {
        const double turn = 2 * piD * (i + 0.3) / 8;
        View view;
        view.camera =
            test::cameraAt({1.4 * std::cos(turn), 1.4 * std::sin(turn), i % 2 ? 0.9 : 0.4}, {0, 0, 0}, 320, 240, 260);
        const Vec3 eye(view.camera.position());
        view.image = Image(320, 240);
        for (int y = 0; y < 240; ++y)
            for (int x = 0; x < 320; ++x) {
                const Vec3 d = view.camera.rayDirection({float(x) + 0.5f, float(y) + 0.5f});
                const Hit hit = world.tracer->closest({eye, d, 0, 1e30f});
                const Vec3 p = eye + d * hit.distance;
                Rgb shown(0.3f + 0.2f * std::sin(5 * d.x), 0.4f, 0.3f + 0.2f * std::sin(4 * d.y));
                if (hit && p.z > -1e-4f) shown = Rgb(0.8f, 0.7f, 0.5f) * (1 + 0.2f * std::sin(20 * p.x + 9 * p.y));
                else if (hit) shown = Rgb(0.09f, 0.06f, 0.05f);
                view.image.at(x, y) = shown;
            }
        capture.views.push_back(view);
    }
    Progress progress;
    // As it came: with a skirt all around.
    const Mesh whole = test::sheet({-0.75f, -0.55f, 0}, {1.5f, 0, 0}, {0, 1.1f, 0}, 150, 110);
    return slabSides(scene, capture, gatherRadiance(capture, test::sceneOf(whole), {}, progress),
                     std::vector<uint8_t>(mesh.vertexCount(), 0));
}

TEST(SlabSides, ATableGetsItsEdgesAndItsSides) {
    const SlabSides found = sidesOf(test::box({-halfX, -halfY, -thickness}, {halfX, halfY, 0}, 20), rectangularTop());
    EXPECT_EQ(found.edges, 4u);
    EXPECT_NEAR(found.depth, thickness, 0.003);
    EXPECT_NEAR(found.sides.area, 4 * (halfX + halfY) * thickness, 0.1f * 4 * (halfX + halfY) * thickness);
    ASSERT_FALSE(found.moved.empty());
    size_t crooked = 0;
    for (const MeshMend::MovedVertex& m : found.moved) {
        const float off = std::max(std::abs(m.position.x) - halfX, std::abs(m.position.y) - halfY);
        crooked += std::abs(off) > 0.002f;
    }
    EXPECT_LT(crooked * 100, found.moved.size());
    // Sides face outwards, upright.
    const Mesh sides{found.sides.positions, {}, found.sides.triangles};
    for (size_t t = 0; t < sides.triangles.size(); ++t) {
        const Vec3 n = sides.faceNormal(t), p = sides.positions[sides.triangles[t][0]];
        EXPECT_GT(glm::dot(n, p), 0.3f);
        EXPECT_NEAR(n.z, 0, 0.02);
    }
}

TEST(SlabSides, WhatHangsOutInTheMiddleOfAnEdgeGoes) {
    // The rim is in two pieces, a hand's width between them, where a skirt is left.
    const Mesh mesh = top([](const Vec3& p, float crooked) {
        const float reach = p.x < -0.06f ? 0 : p.x < 0.06f ? 0.1f : 0.03f;
        return std::abs(p.x) < halfX + crooked && p.y > -halfY - crooked && p.y < halfY + reach + crooked;
    });
    const SlabSides found = sidesOf(test::box({-halfX, -halfY, -thickness}, {halfX, halfY, 0}, 20), mesh);
    EXPECT_EQ(found.edges, 4u);
    std::vector<Vec3> positions = mesh.positions;
    for (const MeshMend::MovedVertex& m : found.moved) positions[m.vertex] = m.position;
    for (uint32_t t = 0; t < mesh.triangles.size(); ++t) {
        if (std::binary_search(found.removed.begin(), found.removed.end(), t)) continue;
        for (const uint32_t v : mesh.triangles[t]) EXPECT_LT(positions[v].y, halfY + 0.003f) << positions[v].x;
    }
}

TEST(SlabSides, ACarpetGetsEdgesWithoutSides) {
    const SlabSides found =
        sidesOf(test::sheet({-halfX, -halfY, 0}, {2 * halfX, 0, 0}, {0, 2 * halfY, 0}, 20, 20), rectangularTop());
    EXPECT_EQ(found.edges, 4u);
    EXPECT_EQ(found.depth, 0);
    EXPECT_TRUE(found.sides.triangles.empty());
}

TEST(SlabSides, ARoundTableStaysRound) {
    Mesh disc = test::discAbove(0.5f, 0, 200);
    for (Triangle& t : disc.triangles) std::swap(t[1], t[2]);
    for (Vec3& n : disc.normals) n = -n;
    const SlabSides found =
        sidesOf(disc, top([](const Vec3& p, float crooked) { return glm::length(p) < 0.5f + crooked / 2; }));
    for (const MeshMend::MovedVertex& m : found.moved) EXPECT_NEAR(glm::length(m.position), 0.5f, 0.006f);
    EXPECT_TRUE(found.sides.triangles.empty());
}

}  // namespace
}  // namespace relamp
