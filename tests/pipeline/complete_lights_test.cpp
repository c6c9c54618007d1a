// A panel overhead that the frame of every photograph cuts: what the photographs show of it, and how far it goes on.
#include "pipeline/complete_lights.h"

#include <gtest/gtest.h>

#include "radiance/gather.h"
#include "support/estimates.h"

namespace relamp {
namespace {

const Rgb panelLight(30, 27, 22);
constexpr float evenSky = 0.3f;

/// A floor under a panel of 0.7 x 0.3 m, both lit by it and an even sky; six photographs from one side, whose upper
/// edges cut it in the middle or from all around. The mesh has of it what lies beyond `meshFrom` along X.
struct CutPanel {
    Capture capture;
    Scene scene;
    RadianceSamples samples;
    EmitterClusters clusters;

    static constexpr float halfLength = 0.35f, halfWidth = 0.15f, height = 0.6f;
    static Mesh panel() {
        return test::box({-halfLength, -halfWidth, height}, {halfLength, halfWidth, height + 0.02f}, 14);
    }
    static Mesh floor() { return test::sheet({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, 40, 40); }

    /// What an albedo of 0.5 sends at a point of the floor; the panel's part by Lambert's formula for polygons.
    static Rgb floorRadiance(const Vec3& p) {
        const Vec3 corners[4] = {{-halfLength, -halfWidth, height},
                                 {-halfLength, halfWidth, height},
                                 {halfLength, halfWidth, height},
                                 {halfLength, -halfWidth, height}};
        float sum = 0;
        for (int k = 0; k < 4; ++k) {
            const Vec3 a = glm::normalize(corners[k] - p), b = glm::normalize(corners[(k + 1) % 4] - p);
            sum += std::acos(std::clamp(glm::dot(a, b), -1.0f, 1.0f)) * glm::normalize(glm::cross(a, b)).z;
        }
        return 0.5f * (std::abs(sum) / (2 * pi) * panelLight + Rgb(evenSky));
    }

    CutPanel(bool fromOneSide, float meshFrom) {
        Mesh truth = floor();
        const size_t floorVertices = truth.vertexCount();
        test::append(truth, panel());
        const Scene real = test::sceneOf(truth);
        for (int i = 0; i < 6; ++i) {
            const double turn = fromOneSide ? (i - 2.5) * piD / 9 : 2 * piD * i / 6;
            const DVec3 out(std::cos(turn), std::sin(turn), 0);
            const Camera camera = test::cameraAt(1.5 * out + DVec3(0, 0, 1.2), 0.2 * out, 160, 120, 160);
            capture.views.push_back(test::photographOf(real, camera, [&](const Hit& hit) {
                if (!hit) return Rgb(evenSky);
                return real.mesh.triangles[hit.triangle][0] >= floorVertices ? panelLight
                                                                             : floorRadiance(real.pointOf(hit));
            }));
        }
        Mesh mesh = floor(), part = panel();
        std::erase_if(part.triangles, [&](const Triangle& t) {
            return part.positions[t[0]].x + part.positions[t[1]].x + part.positions[t[2]].x < 3 * meshFrom;
        });
        test::append(mesh, part);
        scene = test::sceneOf(std::move(mesh));
        capture.mesh = scene.mesh;
        Progress progress;
        samples = gatherRadiance(capture, scene, {}, progress);
        clusters = clusterEmitters(scene, capture, samples, {}, progress);
    }
    std::vector<EmitterReplacement> completed() const {
        Progress progress;
        return completedLights(scene, capture, samples, clusters, solveOptionsFor("draft"), progress);
    }
};

TEST(PartialLights, WhatTheFramesCutFromAllAroundIsOneBox) {
    const CutPanel world(false, 0.1f);
    ASSERT_EQ(world.clusters.emitters.size(), 1u);
    const std::vector<PartialLight> found = partialLights(world.scene, world.capture, world.samples, world.clusters);
    ASSERT_EQ(found.size(), 1u);
    EXPECT_TRUE(found[0].certain);
    EXPECT_TRUE(found[0].showsMore());
    for (const EmitterOutline& o : found[0].outlines) EXPECT_TRUE(o.cut);
    EXPECT_NEAR(found[0].body.half.x, CutPanel::halfLength, 0.008);
    EXPECT_NEAR(found[0].body.half.y, CutPanel::halfWidth, 0.008);
    EXPECT_NEAR(glm::length(found[0].body.centre - DVec3(0, 0, 0.61)), 0, 0.012);
    EXPECT_TRUE(found[0].ends.empty()) << "photographs show its ends";
}

TEST(PartialLights, ABodyEndsWherePhotographsShowThatItDoes) {
    const CutPanel world(true, 0.1f);
    const std::vector<PartialLight> found = partialLights(world.scene, world.capture, world.samples, world.clusters);
    ASSERT_EQ(found.size(), 1u);
    ASSERT_EQ(found[0].ends.size(), 1u);
    const EmitterBody& body = found[0].body;
    EXPECT_EQ(found[0].ends[0].axis, 0);
    EXPECT_LT((body.axes[0] * found[0].ends[0].side).x, -0.9) << "away from the cameras";
    const BodyWitness witness(world.scene, world.capture, world.samples, found[0].mesh);
    EXPECT_TRUE(witness.allow(body));
    EXPECT_TRUE(witness.allow(withEnds(body, found[0].ends, {0.3})));
    OpenEnd other = found[0].ends[0];
    other.side = -other.side;
    EXPECT_FALSE(witness.allow(withEnds(body, {other}, {0.1})));
    EXPECT_NEAR(withEnds(body, {other}, {0.1}).half.x, body.half.x + 0.05, 1e-12);
}

TEST(CompletedLights, TheFloorsLightTellsHowFarAPanelGoesOn) {
    const CutPanel world(true, 0.1f);
    const std::vector<EmitterReplacement> found = world.completed();
    ASSERT_EQ(found.size(), 1u);
    EXPECT_NEAR(2 * found[0].body.half.x, 2 * CutPanel::halfLength, 0.08);
    EXPECT_NEAR(2 * found[0].body.half.y, 2 * CutPanel::halfWidth, 0.02);
    for (const uint32_t t : found[0].place.removed)
        EXPECT_GE(t, CutPanel::floor().triangles.size()) << "the floor stays";
}

TEST(CompletedLights, ACandidateTakesTheShapeThatPhotographsShow) {
    CutPanel world(false, -0.32f);  // so little is missing that light on the floor hardly tells
    ASSERT_EQ(world.clusters.emitters.size(), 1u);
    world.clusters.candidates = std::move(world.clusters.emitters);
    world.clusters.emitters.clear();
    indexEmitters(world.scene, world.clusters);
    const std::vector<EmitterReplacement> found = world.completed();
    ASSERT_EQ(found.size(), 1u);
    EXPECT_NEAR(2 * found[0].body.half.x, 2 * CutPanel::halfLength, 0.02);
    EXPECT_NEAR(2 * found[0].body.half.y, 2 * CutPanel::halfWidth, 0.02);
}

TEST(CompletedLights, AnExactMeshIsLeftAsItIs) { EXPECT_TRUE(CutPanel(false, -1).completed().empty()); }

}  // namespace
}  // namespace relamp
