// A ball with the waves of a reconstruction is round again where it mirrors, and nowhere else.
#include "radiance/mirror_spheres.h"

#include <gtest/gtest.h>

#include "support/estimates.h"

namespace relamp {
namespace {

constexpr float radius = 0.2f, waves = 0.001f;
const Vec3 centre(0.1f, -0.3f, 0.2f);

/// A sky of patches of light and dark.
float skyAt(const Vec3& d) { return 1 + 0.9f * std::sin(4 * d.x + 1) * std::sin(5 * d.y) * std::cos(3 * d.z); }

/// A board and, apart from it, what stands on it.
struct Stage {
    Scene scene;
    RadianceSamples samples;

    explicit Stage(Mesh thing, float off, bool mirror) {
        for (Vec3& p : thing.positions) {
            const Vec3 d = glm::normalize(p - centre);
            p += off * std::sin(11 * d.x) * std::sin(9 * d.y + 1) * std::cos(8 * d.z) * d;
        }
        thing.normals = vertexNormalsFromFaces(thing);
        Mesh mesh = test::sheet({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, 20, 20);
        const size_t board = mesh.vertexCount();
        test::append(mesh, thing);
        scene = test::sceneOf(mesh);
        samples.start.push_back(0);
        for (uint32_t v = 0; v < mesh.vertexCount(); ++v) {
            for (uint32_t view = 0; view < 6; ++view) addSample(v, view, mirror && v >= board);
            samples.start.push_back(uint32_t(samples.samples.size()));
        }
    }
    std::vector<MirrorSphere> balls() const {
        return mirrorSpheres(scene, samples, std::vector<uint8_t>(scene.mesh.vertexCount(), 0));
    }

private:
    void addSample(uint32_t v, uint32_t view, bool mirrors) {
        const float turn = 2 * pi * float(view) / 6;
        const Vec3 eye(2 * std::cos(turn), 2 * std::sin(turn), 1.2f),
            n = scene.mesh.normals[v], to = glm::normalize(eye - scene.mesh.positions[v]);
        if (glm::dot(n, to) < 0.15f) return;
        const Rgb shown(mirrors ? skyAt(2 * glm::dot(n, to) * n - to) : 0.6f);
        samples.samples.push_back({view, shown, 1, false});
    }
};

TEST(MirrorSpheres, AreRoundAgain) {
    const Stage stage(test::ball(centre, radius, 60, 120), waves, true);
    const std::vector<MirrorSphere> found = stage.balls();
    ASSERT_EQ(found.size(), 1u);
    EXPECT_NEAR(found[0].radius, double(radius), 1e-4);
    EXPECT_LT(glm::length(Vec3(found[0].centre) - centre), 1e-4f);
    EXPECT_GT(found[0].vertices.size(), 6000u);
    const RoundedSphere round = roundedSphere(found[0], stage.scene.mesh);
    ASSERT_EQ(round.moved.size(), found[0].vertices.size());
    for (size_t i = 0; i < round.moved.size(); ++i) {
        const Vec3 from = round.moved[i].position - centre;
        EXPECT_NEAR(glm::length(from), radius, 3e-4f);
        EXPECT_GT(glm::dot(from, round.turned[i].normal), 0.9999f * glm::length(from));
    }
    const std::vector<uint8_t> marked = verticesOfSpheres(found, stage.scene.mesh.vertexCount());
    EXPECT_EQ(size_t(std::count(marked.begin(), marked.end(), 1)), found[0].vertices.size());
}

TEST(MirrorSpheres, ExactOnesStayToTheBit) {
    const Stage stage(test::ball(centre, radius, 60, 120), 0, true);
    const std::vector<MirrorSphere> found = stage.balls();
    ASSERT_EQ(found.size(), 1u);
    EXPECT_TRUE(roundedSphere(found[0], stage.scene.mesh).moved.empty());
}

TEST(MirrorSpheres, WhatLooksAlikeFromEverywhereIsNone) {
    EXPECT_TRUE(Stage(test::ball(centre, radius, 60, 120), waves, false).balls().empty());
}

TEST(MirrorSpheres, ASwitchedLightIsNoMirror) {
    Stage stage(test::ball(centre, radius, 60, 120), waves, false);
    for (RadianceSample& s : stage.samples.samples) s.radiance *= s.view % 2 ? 1.0f : 0.4f;
    EXPECT_EQ(stage.balls().size(), 0u) << "the board changes as much";
    stage.samples.states = 2;
    for (uint32_t view = 0; view < 6; ++view) stage.samples.stateOfView.push_back(view % 2);
    EXPECT_TRUE(stage.balls().empty());
}

TEST(MirrorSpheres, NeitherIsAnEggOrABox) {
    Mesh egg = test::ball(centre, radius, 60, 120);
    for (Vec3& p : egg.positions) p.z = centre.z + 1.3f * (p.z - centre.z);
    EXPECT_TRUE(Stage(egg, 0, true).balls().empty());
    EXPECT_TRUE(Stage(test::box(centre - Vec3(0.2f), centre + Vec3(0.2f), 30), 0, true).balls().empty());
}

TEST(MirrorSpheres, LightsAreNotAsked) {
    const Stage stage(test::ball(centre, radius, 60, 120), waves, true);
    const std::vector<uint8_t> all(stage.scene.mesh.vertexCount(), 1);
    EXPECT_TRUE(mirrorSpheres(stage.scene, stage.samples, all).empty());
}

}  // namespace
}  // namespace relamp
