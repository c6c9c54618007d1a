#include "pipeline/working_mesh.h"

#include <gtest/gtest.h>

#include "support/estimates.h"
#include "support/shapes.h"

namespace relamp {
namespace {

/// A finely cut floor with a square emitter above it.
struct Room {
    Capture capture;
    size_t ofFloor = 0;

    Room() {
        capture.mesh = test::sheet({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, 120, 120);
        ofFloor = capture.mesh.vertexCount();
        test::append(capture.mesh, test::sheet({-0.2f, -0.2f, 0.8f}, {0, 0.4f, 0}, {0.4f, 0, 0}, 24, 24));
    }
};

TEST(WorkingMesh, SmallMeshesAndThoseTheUserWantsWholeAreLeftAlone) {
    const Room room;
    Progress progress;
    EXPECT_FALSE(workingMesh(room.capture, {}, progress));
    EXPECT_FALSE(workingMesh(room.capture, 0, progress));
    EXPECT_FALSE(workingMesh(room.capture, 1000000, progress));
}

TEST(WorkingMesh, WhatIsFoundOnItIsCarriedBack) {
    Room room;
    const ProxyLight proxy{{0.5f, 0.5f, 0.5f}, 0.02f, Vec3(0), false};
    room.capture.proxies = {proxy};
    addProxies(room.capture.proxies, room.capture.mesh);
    Progress progress;
    const std::optional<DecimatedMesh> working = workingMesh(room.capture, 3000, progress);
    ASSERT_TRUE(working);
    EXPECT_LE(working->mesh.triangles.size(), 3000 + proxyTriangles);
    const Scene scene = buildScene(working->mesh, progress);
    // An albedo that rises along x; two emitters: the square and the proxy.
    std::vector<uint32_t> square, ball;
    for (uint32_t t = 0; t < working->mesh.triangles.size(); ++t) {
        const Vec3 p = working->mesh.positions[working->mesh.triangles[t][0]];
        if (t >= working->mesh.triangles.size() - proxyTriangles) ball.push_back(t);
        else if (p.z > 0.7f) square.push_back(t);
    }
    Estimate found =
        test::matteEstimate(scene, Rgb(0.5f), Rgb(0), test::emittersOf(scene, {square, ball}, {Rgb(9), Rgb(4)}));
    for (size_t v = 0; v < scene.mesh.vertexCount(); ++v)
        if (found.emitters.emitterOfVertex[v] < 0)
            found.reflectance.weight[0][v] = Rgb(0.5f + 0.3f * scene.mesh.positions[v].x);
    const Estimate whole = carriedBack(found, *working, room.capture.mesh);
    const size_t n = room.capture.mesh.vertexCount();
    ASSERT_EQ(whole.reflectance.weight[0].size(), n);
    ASSERT_EQ(whole.reflectance.observed.size(), n);
    ASSERT_EQ(whole.emitters.emitters.size(), 2u);
    for (size_t v = 0; v < room.ofFloor; ++v) {
        EXPECT_EQ(whole.emitters.emitterOfVertex[v], -1);
        EXPECT_NEAR(whole.reflectance.weight[0][v].x, 0.5f + 0.3f * room.capture.mesh.positions[v].x, 2e-3f);
    }
    for (size_t v = room.ofFloor; v < n; ++v) {
        ASSERT_GE(whole.emitters.emitterOfVertex[v], 0);
        EXPECT_EQ(whole.reflectance.weight[0][v], Rgb(0));
    }
    double area = 0;
    for (const EmitterCluster& e : whole.emitters.emitters) area = std::max(area, double(e.area));
    EXPECT_NEAR(area, 0.16, 1e-4);
    EXPECT_EQ(std::count(whole.emitters.emitterOfTriangle.begin(), whole.emitters.emitterOfTriangle.end(), -1),
              2 * 120 * 120);
}

}  // namespace
}  // namespace relamp
