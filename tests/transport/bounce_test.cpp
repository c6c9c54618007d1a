#include "transport/bounce.h"

#include <gtest/gtest.h>

#include "base/parallel.h"
#include "support/shapes.h"
#include "support/stopping.h"

namespace relamp {
namespace {

BounceRays traced(const Scene& scene, uint32_t rays = 256) {
    Progress progress;
    return traceBounce(scene, {rays, 1}, progress);
}

/// The inside of a ball.
Mesh cavity() {
    Mesh mesh = test::ball({0, 0, 0}, 1, 24, 36);
    for (Vec3& n : mesh.normals) n = -n;
    for (Triangle& t : mesh.triangles) std::swap(t[1], t[2]);
    return mesh;
}

TEST(Bounce, InsideABallThereIsNothingButSurface) {
    const Scene scene = test::sceneOf(cavity());
    const BounceRays rays = traced(scene);
    for (uint32_t v = 0; v < rays.vertexCount(); ++v) EXPECT_EQ(rays.enclosure(v), 1) << v;
}

TEST(Bounce, InsideABallLightAddsUpToTheGeometricSeries) {
    const Scene scene = test::sceneOf(cavity());
    const BounceRays rays = traced(scene, 64);
    const size_t n = scene.mesh.vertexCount();
    // direct 1, albedo a: bounced = a + a^2 + ... = a / (1 - a)
    const std::vector<Rgb> bounced =
        bounceOf(rays, std::vector<Rgb>(n, Rgb(0.25f, 0.5f, 0.75f)), std::vector<Rgb>(n, Rgb(1, 2, 1)));
    for (size_t v = 0; v < n; ++v) {
        EXPECT_NEAR(bounced[v].x, 1.0f / 3, 0.001);
        EXPECT_NEAR(bounced[v].y, 2, 0.01);
        EXPECT_NEAR(bounced[v].z, 3, 0.015);
    }
}

TEST(Bounce, ASquareAboveSendsItsFormFactor) {
    Mesh mesh = test::sheet({-0.05f, -0.05f, 0}, {0.1f, 0, 0}, {0, 0.1f, 0}, 2, 2);
    const size_t floor = mesh.vertexCount();
    test::append(mesh, test::squareAbove(1.5f, 0, 0, 0.8f, 12));
    const Scene scene = test::sceneOf(mesh);
    std::vector<Rgb> outgoing(mesh.vertexCount(), Rgb(3));
    for (size_t v = 0; v < floor; ++v) outgoing[v] = Rgb(0);
    const Rgb shown = gatherBounce(traced(scene, 1024), outgoing)[4];  // the middle of the small floor
    EXPECT_NEAR(shown.x, 3 * test::centredSquareFormFactor(1.5, 0.8), 0.02);
}

TEST(Bounce, WhatLightPassesSendsWhatCamerasSeeOfIt) {
    // A skin over a shade's opening shows the light of the shade's inside.
    Mesh mesh = test::sheet({-0.05f, -0.05f, 0}, {0.1f, 0, 0}, {0, 0.1f, 0}, 2, 2);
    mesh.shadowless = test::append(mesh, test::squareAbove(1.5f, 0, 0, 0.8f, 12));
    const Scene scene = test::sceneOf(mesh);
    EXPECT_FALSE(scene.tracer->occluded({Vec3(0, 0, 0.01f), Vec3(0, 0, 1)}));
    EXPECT_NEAR(traced(scene, 1024).enclosure(4), test::centredSquareFormFactor(1.5, 0.8), 0.01);
}

TEST(Bounce, TheBackOfASurfaceSendsNothing) {
    Mesh mesh = test::sheet({-0.05f, -0.05f, 0}, {0.1f, 0, 0}, {0, 0.1f, 0});
    test::append(mesh, test::sheet({-1, -1, 0.5f}, {2, 0, 0}, {0, 2, 0}));  // faces up
    const Scene scene = test::sceneOf(mesh);
    EXPECT_EQ(traced(scene).enclosure(0), 0);
}

TEST(Bounce, RaysAreNotSharedAroundACornerNorNearWhatTheyMeet) {
    Mesh mesh = test::sheet({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, 20, 20);
    test::append(mesh, test::sheet({-1, 1, 0}, {2, 0, 0}, {0, 0, 1}, 20, 10));
    const Scene scene = test::sceneOf(mesh);
    const BounceRays rays = traced(scene);
    for (uint32_t v = 0; v < rays.vertexCount(); ++v)
        for (uint32_t i = rays.sharedStart[v]; i < rays.sharedStart[v + 1]; ++i)
            EXPECT_GT(glm::dot(scene.mesh.normals[v], scene.mesh.normals[rays.shared[i]]), 0.9f);
    const uint32_t far = 10, near = 20 * 21 + 10;  // middle of the front edge; at the foot of the wall
    EXPECT_GT(rays.sharedStart[far + 1] - rays.sharedStart[far], 2u);
    EXPECT_EQ(rays.sharedStart[near + 1] - rays.sharedStart[near], 0u);
}

TEST(Bounce, HasTheSameBitsOnAnyNumberOfThreads) {
    const Scene scene = test::sceneOf(test::box({0, 0, 0}, {1, 1, 1}, 6));
    const auto run = [&](int threads) {
        const ThreadLimit limit(threads);
        return traced(scene);
    };
    const BounceRays one = run(1), many = run(0);
    EXPECT_EQ(one.start, many.start);
    EXPECT_EQ(one.sender, many.sender);
}

TEST(Bounce, CanBeStopped) {
    const Scene scene = test::sceneOf(test::box({0, 0, 0}, {1, 1, 1}, 60));
    Progress progress;
    progress.requestStop();
    EXPECT_THROW(traceBounce(scene, {}, progress), Cancelled);
}

}  // namespace
}  // namespace relamp
