#include "solve/state/bounce_model.h"

#include <gtest/gtest.h>

#include "support/shapes.h"

namespace relamp {
namespace {

/// Two vertices that see each other with half of their rays; vertex 2 sees vertex 1 with all of them.
BounceModel threeVertices() {
    const Mesh cavity = [] {
        Mesh mesh = test::ball({0, 0, 0}, 1, 12, 18);
        for (Vec3& n : mesh.normals) n = -n;
        for (Triangle& t : mesh.triangles) std::swap(t[1], t[2]);
        return mesh;
    }();
    const Scene scene = test::sceneOf(cavity);
    Progress progress;
    BounceModel model;
    model.rays = traceBounce(scene, {64, 1}, progress);
    return model;
}

MatteObservations observed(const std::vector<uint32_t>& vertices) {
    MatteObservations matte;
    matte.vertices = vertices;
    return matte;
}

TEST(BounceModel, OfSurfacesThatPhotographsShowTakesTheirRadiance) {
    BounceModel model = threeVertices();
    const size_t n = model.rays.vertexCount();
    std::vector<uint32_t> all(n);
    for (uint32_t v = 0; v < n; ++v) all[v] = v;
    EXPECT_TRUE(model.hiddenSenders(all, std::vector<uint8_t>(n, 0)).empty());
    model.take(observed(all), std::vector<Rgb>(n, Rgb(2, 3, 4)), n, {});
    ASSERT_TRUE(model.joined());
    // A closed room of one radiance: as a white surface shows it, all of it arrives.
    for (const Rgb& b : model.atObservation) {
        EXPECT_NEAR(b.x, 2, 1e-4);
        EXPECT_NEAR(b.y, 3, 1e-4);
        EXPECT_NEAR(b.z, 4, 1e-4);
    }
}

TEST(BounceModel, HiddenSurfacesSendTheirAlbedoTimesTheirLight) {
    BounceModel model = threeVertices();
    const size_t n = model.rays.vertexCount();
    BounceModel::HiddenSenders hidden;
    hidden.vertices = model.hiddenSenders({}, std::vector<uint8_t>(n, 0));
    ASSERT_GT(hidden.vertices.size(), n / 2);
    EXPECT_TRUE(std::is_sorted(hidden.vertices.begin(), hidden.vertices.end()));
    hidden.albedo.assign(hidden.vertices.size(), Rgb(0.5f));
    hidden.direct.assign(hidden.vertices.size(), Rgb(1));
    model.take({}, {}, n, {hidden});
    // direct 1, albedo a: a + a^2 + ... = a / (1 - a), ten rounds of it.
    for (size_t v = 0; v < n; ++v) EXPECT_NEAR(model.atVertex[v].x, 1, 0.01) << v;
}

TEST(BounceModel, LightingStatesDoNotLightEachOther) {
    BounceModel model = threeVertices();
    const size_t n = model.rays.vertexCount();
    MatteObservations both;
    std::vector<Rgb> radiance;
    for (size_t k = 0; k < 2 * n; ++k) {
        both.vertices.push_back(uint32_t(k % n));
        radiance.push_back(k < n ? Rgb(1) : Rgb(4));
    }
    both.stateStart = {0, uint32_t(n), uint32_t(2 * n)};
    model.take(both, radiance, n, {});
    ASSERT_EQ(model.atObservation.size(), 2 * n);
    EXPECT_NEAR(model.atObservation[0].x, 1, 1e-4);
    EXPECT_NEAR(model.atObservation[n].x, 4, 1e-4);
    for (const Rgb& b : model.along(model.rays, both)) EXPECT_GT(b.x, 0.9f);
    EXPECT_NEAR(model.along(model.rays, both)[n].x, 4, 1e-4);
}

TEST(BounceModel, EmittersAreNoHiddenSenders) {
    const BounceModel model = threeVertices();
    const size_t n = model.rays.vertexCount();
    EXPECT_TRUE(model.hiddenSenders({}, std::vector<uint8_t>(n, 1)).empty());
}

TEST(BounceModel, WithdrawnItKeepsItsRaysAndForgottenItSaysWhy) {
    BounceModel model = threeVertices();
    const size_t n = model.rays.vertexCount();
    model.take(observed({0, 1}), {Rgb(1), Rgb(1)}, n, {});
    model.withdraw();
    EXPECT_TRUE(model.traced());
    EXPECT_FALSE(model.joined());
    EXPECT_EQ(model.offset(), nullptr);
    model.forget("of the test");
    EXPECT_FALSE(model.traced());
    EXPECT_EQ(model.absentBecause, "of the test");
}

}  // namespace
}  // namespace relamp
