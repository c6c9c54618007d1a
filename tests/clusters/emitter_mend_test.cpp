// Emitters that the mesh does not show as the photographs do.
#include "clusters/emitter_mend.h"

#include <gtest/gtest.h>

#include "base/statistics.h"
#include "clusters/emitter_pixels.h"
#include "clusters/emitter_sphere.h"
#include "clusters/photographed_light.h"

namespace relamp {
namespace {

using World = test::PhotographedLight;
using test::ballOf, test::boxOf, test::eggOf, test::light, test::surfaceOf, test::tubeOf;

TEST(EmitterMend, AnExactMeshStaysAsItIs) {
    for (const Mesh& truth : {ballOf({0, 0, 0.4f}, 0.1f), boxOf({0, 0, 0.4f}, {0.2f, 0.15f, 0.02f})}) {
        const World world(truth, truth);
        ASSERT_EQ(world.clusters.emitters.size(), 1u);
        EXPECT_FALSE(world.mend().needed());
    }
}

TEST(EmitterMend, ABallThatTheMeshHasHalfOfIsFoundWithItsSize) {
    const Vec3 centre(0.05f, -0.1f, 0.4f);
    Mesh half = ballOf(centre, 0.1f);
    std::erase_if(half.triangles, [&](const Triangle& t) {
        return half.positions[t[0]].x + half.positions[t[1]].x + half.positions[t[2]].x < 3 * centre.x;
    });
    const World world(ballOf(centre, 0.1f), half);
    ASSERT_EQ(world.clusters.emitters.size(), 1u);
    const EmitterMend mend = world.mend();
    ASSERT_EQ(mend.balls.size(), 1u);
    EXPECT_NEAR(glm::length(Vec3(mend.balls[0].centre) - centre), 0, 0.002);
    EXPECT_NEAR(mend.balls[0].radius, 0.1f, 0.002f);
    EXPECT_NEAR(mend.balls[0].radiance.x, light.x, 0.01f * light.x);
    // Its half of a mesh goes, the floor stays.
    EXPECT_EQ(mend.removed.size(), half.triangles.size());
    EXPECT_GE(mend.removed.front(), world.floorTriangles);
}

TEST(EmitterMend, ShredsOfABallAreOneBall) {
    const Vec3 centre(0.05f, -0.1f, 0.4f);
    Mesh shreds = ballOf(centre, 0.1f);
    std::erase_if(shreds.triangles, [&](const Triangle& t) {
        const Vec3 middle = (shreds.positions[t[0]] + shreds.positions[t[1]] + shreds.positions[t[2]]) / 3.0f;
        return std::abs(middle.x - centre.x) < 0.06f;
    });
    const World world(ballOf(centre, 0.1f), shreds);
    ASSERT_EQ(world.clusters.emitters.size(), 2u);
    const EmitterMend mend = world.mend();
    ASSERT_EQ(mend.balls.size(), 1u);
    EXPECT_TRUE(mend.moves.empty());
    EXPECT_NEAR(glm::length(Vec3(mend.balls[0].centre) - centre), 0, 0.002);
    EXPECT_NEAR(mend.balls[0].radius, 0.1f, 0.002f);
    EXPECT_EQ(mend.removed.size(), shreds.triangles.size());
}

TEST(EmitterMend, WhatLiesBeforeABallThroughWhichItIsSeenGoes) {
    const Vec3 centre(0, 0, 0.4f);
    // A curtain of mesh all around, which no photograph knows of, open above.
    Mesh mesh = ballOf(centre, 0.05f);
    const size_t own = mesh.triangles.size();
    for (int i = 0; i < 6; ++i) {
        const double a = 2 * piD * i / 6 + piD / 6;
        const Vec3 out(float(0.12 * std::cos(a)), float(0.12 * std::sin(a)), 0),
            along(float(-0.05 * std::sin(a)), float(0.05 * std::cos(a)), 0);
        test::append(mesh, test::sheet(centre + out - along - Vec3(0, 0, 0.04f), 2.0f * along, {0, 0, 0.06f}, 6, 4));
    }
    const World world(ballOf(centre, 0.05f), mesh);
    ASSERT_EQ(world.clusters.emitters.size(), 1u);
    const EmitterMend mend = world.mend();
    ASSERT_EQ(mend.balls.size(), 1u);
    EXPECT_NEAR(mend.balls[0].radius, 0.05f, 0.002f);
    EXPECT_GT(mend.removed.size(), own + 10);
    EXPECT_GE(mend.removed.front(), world.floorTriangles);
}

TEST(EmitterMend, OneViewOfAllOfABallAndOneOfAPartAreEnough) {
    const Vec3 centre(0, 0, 0.4f);
    Mesh half = ballOf(centre, 0.1f), screens;
    std::erase_if(half.triangles, [&](const Triangle& t) { return half.positions[t[0]].z > centre.z; });
    // Of the six cameras the first sees all of it, the second 45 % of it, the others nothing.
    for (int i = 1; i < 6; ++i) {
        const double a = 2 * piD * i / 6;
        const Vec3 out(float(std::cos(a)), float(std::sin(a)), 0), along(-out.y, out.x, 0);
        const Vec3 corner = centre + 0.3f * out - (i == 1 ? 0.01f : 0.2f) * along - Vec3(0, 0, 0.08f);
        test::append(screens, test::sheet(corner, 0.4f * along, {0, 0, 0.4f}, 8, 8));
    }
    const World world(ballOf(centre, 0.1f), half, screens);
    ASSERT_EQ(world.clusters.emitters.size(), 1u);
    const EmitterMend mend = world.mend();
    ASSERT_EQ(mend.balls.size(), 1u);
    EXPECT_NEAR(glm::length(Vec3(mend.balls[0].centre) - centre), 0, 0.005);
    EXPECT_NEAR(mend.balls[0].radius, 0.1f, 0.003f);
}

/// Two balls of one light; from some of the cameras one hides part of the other.
constexpr float pairRadius = 0.06f;
const Vec3 nearer(-0.1f, 0, 0.4f), farther(0.1f, 0, 0.4f);

TEST(EmitterMend, LightsThatHideEachOtherAreNotOneBall) {
    Mesh both = ballOf(nearer, pairRadius);
    test::append(both, ballOf(farther, pairRadius));
    const World world(both, both);
    ASSERT_EQ(world.clusters.emitters.size(), 2u);
    EXPECT_FALSE(world.mend().needed());
}

TEST(EmitterMend, ALightBeforeABallIsNoObstacle) {
    Mesh both = ballOf(nearer, pairRadius), part = both;
    test::append(both, ballOf(farther, pairRadius));
    const size_t whole = part.triangles.size();
    Mesh half = ballOf(farther, pairRadius);
    std::erase_if(half.triangles, [&](const Triangle& t) { return half.positions[t[0]].z < farther.z; });
    test::append(part, half);
    const World world(both, part);
    ASSERT_EQ(world.clusters.emitters.size(), 2u);
    const EmitterMend mend = world.mend();
    ASSERT_EQ(mend.balls.size(), 1u);
    EXPECT_NEAR(glm::length(Vec3(mend.balls[0].centre) - farther), 0, 0.002);
    EXPECT_NEAR(mend.balls[0].radius, pairRadius, 0.002f);
    EXPECT_GE(mend.removed.front(), world.floorTriangles + whole);
}

TEST(EmitterMend, BallsThatTouchInPhotographsAreFittedTogether) {
    // Of each the mesh has a cap at the far side from the other, so that it does not tell their pixels apart.
    const Vec3 first(-0.068f, 0, 0.4f), second(0.068f, 0, 0.4f);
    Mesh both = ballOf(first, pairRadius), caps;
    test::append(both, ballOf(second, pairRadius));
    for (const Vec3& centre : {first, second}) {
        Mesh cap = ballOf(centre, pairRadius);
        std::erase_if(cap.triangles, [&](const Triangle& t) {
            return (cap.positions[t[0]].x - centre.x) * (centre.x < 0 ? -1 : 1) < 0.02f;
        });
        test::append(caps, cap);
    }
    const World world(both, caps);
    ASSERT_EQ(world.clusters.emitters.size(), 2u);
    const EmitterMend mend = world.mend();
    ASSERT_EQ(mend.balls.size(), 2u);
    for (const ProxyLight& ball : mend.balls) {
        const Vec3& centre = ball.centre.x < 0 ? first : second;
        EXPECT_NEAR(glm::length(Vec3(ball.centre) - centre), 0, 0.003);
        EXPECT_NEAR(ball.radius, pairRadius, 0.002f);
    }
}

TEST(EmitterMend, AShrunkenEggMovesOutByWhatIsMissing) {
    const Vec3 size(0.24f, 0.12f, 0.06f);
    const World world(eggOf({0, 0, 0.4f}, size), eggOf({0, 0, 0.4f}, size - 0.012f));
    ASSERT_EQ(world.clusters.emitters.size(), 1u);
    const EmitterMend mend = world.mend();
    EXPECT_TRUE(mend.balls.empty());
    EXPECT_TRUE(mend.bodies.empty());
    ASSERT_EQ(mend.moves.size(), 1u);
    MeshMend moves;
    moves.moved = mend.moves[0].vertices;
    Mesh moved = world.capture.mesh;
    applyMend(moves, moved);
    float widest = 0;
    for (const MeshMend::MovedVertex& m : moves.moved) widest = std::max(widest, m.position.x);
    EXPECT_NEAR(widest, size.x, 0.006f);
    EXPECT_EQ(moved.triangles.size(), world.capture.mesh.triangles.size());
}

TEST(EmitterMend, AMoveIsJudgedByTheEmitterThatItIsFor) {
    const Vec3 size(0.24f, 0.12f, 0.06f);
    const Mesh truth = eggOf({0, 0, 0.4f}, size);
    const World before(truth, eggOf({0, 0, 0.4f}, size - 0.012f));
    const EmitterMend mend = before.mend();
    ASSERT_EQ(mend.moves.size(), 1u);
    const auto overlapIn = [&](const World& after) {
        return overlapAfter(mend.moves[0], after.scene, after.capture, after.samples, after.clusters);
    };
    EXPECT_GT(overlapIn(World(truth, truth)), 0.97f);
    EXPECT_NEAR(overlapIn(before), mend.moves[0].overlap, 1e-6f);
    EXPECT_EQ(overlapIn(World(truth, {})), 0);  // it was lost
}

TEST(EmitterMend, ABallThatAllFramesCutIsFoundWithItsSize) {
    const Vec3 centre(0, 0, 0.4f);
    Mesh half = ballOf(centre, 0.1f);
    std::erase_if(half.triangles, [&](const Triangle& t) {
        return half.positions[t[0]].z + half.positions[t[1]].z + half.positions[t[2]].z > 3 * centre.z;
    });
    World world(ballOf(centre, 0.1f), half);
    // Every photograph loses its upper rows, down to a little above the ball's middle.
    for (View& view : world.capture.views) {
        const int rows = int(view.camera.project(DVec3(centre))->y) - 6, width = view.image.width;
        view.image.pixels.erase(view.image.pixels.begin(), view.image.pixels.begin() + ptrdiff_t(rows) * width);
        if (!view.image.usable.empty())
            view.image.usable.erase(view.image.usable.begin(), view.image.usable.begin() + ptrdiff_t(rows) * width);
        view.image.height -= rows;
        view.camera.height -= rows;
        view.camera.centreY -= rows;
    }
    Progress progress;
    world.samples = gatherRadiance(world.capture, world.scene, {}, progress);
    world.clusters = clusterEmitters(world.scene, world.capture, world.samples, {}, progress);
    ASSERT_EQ(world.clusters.emitters.size(), 1u);
    EXPECT_TRUE(
        emitterOutlines(world.scene, world.capture, world.samples, world.clusters, world.clusters.emitters[0]).empty());
    const EmitterMend mend = world.mend();
    ASSERT_EQ(mend.balls.size(), 1u);
    EXPECT_NEAR(glm::length(Vec3(mend.balls[0].centre) - centre), 0, 0.004);
    EXPECT_NEAR(mend.balls[0].radius, 0.1f, 0.003f);
}

TEST(EmitterMend, ACandidateTooBrightToReflectIsAskedToo) {
    const Vec3 centre(0.05f, -0.1f, 0.4f);
    Mesh half = ballOf(centre, 0.1f);
    std::erase_if(half.triangles, [&](const Triangle& t) {
        return half.positions[t[0]].x + half.positions[t[1]].x + half.positions[t[2]].x < 3 * centre.x;
    });
    World world(ballOf(centre, 0.1f), half);
    // Vertices at its edge have made it darker than it is.
    world.clusters.candidates = world.clusters.emitters;
    world.clusters.candidates[0].radiance *= 0.96f;
    world.clusters.emitters.clear();
    std::fill(world.clusters.emitterOfTriangle.begin(), world.clusters.emitterOfTriangle.end(), -1);
    const EmitterMend mend = world.mend();
    ASSERT_EQ(mend.balls.size(), 1u);
    EXPECT_NEAR(mend.balls[0].radius, 0.1f, 0.002f);
    EXPECT_NEAR(mend.balls[0].radiance.x, light.x, 0.005f * light.x);
    EXPECT_EQ(mend.removed.size(), half.triangles.size());
    world.clusters.candidates[0].evidence.sceneContrast = 5;
    EXPECT_FALSE(world.mend().needed()) << "a bright wall may be that bright";
}

TEST(ThinEmitters, AStripOfTwoPixelsIsAnEmitterWithItsRadiance) {
    const Mesh strip = boxOf({0.1f, 0, 0.4f}, {0.3f, 0.009f, 0.009f});
    const World world(strip, strip);
    ASSERT_EQ(world.clusters.emitters.size(), 1u);
    const EmitterCluster& e = world.clusters.emitters[0];
    EXPECT_EQ(e.triangles.size(), strip.triangles.size());
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(e.radiance[c], light[c], 0.02f * light[c]);
    EXPECT_FALSE(world.mend().needed());
}

TEST(ThinEmitters, AThinBarThatIsNoBrighterIsNone) {
    const Mesh bar = boxOf({0.1f, 0, 0.4f}, {0.3f, 0.009f, 0.009f});
    const World world({}, bar);  // photographs show the floor and the dark behind it
    EXPECT_TRUE(world.clusters.emitters.empty());
    EXPECT_TRUE(world.clusters.candidates.empty());
}

TEST(EmitterMend, ABallThatTheMeshLacksIsNoneWithoutPhotographsOfIt) {
    const World world({}, {});
    EXPECT_FALSE(world.mend().needed());
}
TEST(MeshMend, TriangleAndVertexNumbersAreChecked) {
    Mesh mesh = World::floor({});
    MeshMend mend;
    mend.removed = {0, 5};
    mend.moved = {{3, {1, 2, 3}}};
    const size_t before = mesh.triangles.size();
    applyMend(mend, mesh);
    EXPECT_EQ(mesh.triangles.size(), before - 2);
    const std::vector<uint32_t> left = trianglesLeft(mend, before);
    ASSERT_EQ(left.size(), before - 2);
    EXPECT_EQ(left[0], 1u);
    EXPECT_EQ(left[4], 6u);
    EXPECT_EQ(mesh.positions[3], Vec3(1, 2, 3));
    mend.removed = {uint32_t(before)};
    EXPECT_THROW(applyMend(mend, mesh), Error);
    mend = {};
    mend.moved = {{uint32_t(mesh.vertexCount()), {0, 0, 0}}};
    EXPECT_THROW(applyMend(mend, mesh), Error);
    mend = {};
    mend.turned = {{2, {2, 0, 0}}};
    applyMend(mend, mesh);
    EXPECT_EQ(mesh.normals[2], Vec3(1, 0, 0));
    mend.turned = {{2, {0, 0, 0}}};
    EXPECT_THROW(applyMend(mend, mesh), Error);
    mend.turned = {{uint32_t(mesh.vertexCount()), {0, 0, 1}}};
    EXPECT_THROW(applyMend(mend, mesh), Error);
}

TEST(MeshMend, AddsVerticesAndTrianglesBehindTheFile) {
    Mesh mesh = World::floor({});
    const size_t vertices = mesh.vertexCount(), triangles = mesh.triangles.size();
    MeshMend mend;
    mend.removed = {0};
    mend.addedPositions = {{0, 0, 1}, {1, 0, 1}, {0, 1, 1}};
    mend.added = {{0, 1, 2}};
    mend.moved = {{uint32_t(vertices) + 2, {0, 2, 1}}};
    Mesh added = mesh;
    applyMend(mend, added);
    ASSERT_EQ(added.vertexCount(), vertices + 3);
    ASSERT_EQ(added.normals.size(), vertices + 3);
    ASSERT_EQ(added.triangles.size(), triangles);
    EXPECT_EQ(added.triangles.back()[0], vertices);
    EXPECT_EQ(added.normals.back(), Vec3(0, 0, 1));
    EXPECT_EQ(added.positions.back(), Vec3(0, 2, 1));
    mend.added = {{0, 1, 3}};
    EXPECT_THROW(applyMend(mend, added = mesh), Error);
    mend.added.clear();
    mend.addedPositions[0].x = std::nanf("");
    EXPECT_THROW(applyMend(mend, added = mesh), Error);
}

}  // namespace
}  // namespace relamp
