// A post that a reconstruction has lost.
#include "radiance/missing_parts.h"

#include <gtest/gtest.h>

#include "base/box.h"
#include "radiance/gather.h"
#include "support/estimates.h"
#include "support/point_photograph.h"

namespace relamp {
namespace {

constexpr float postHalf = 0.012f, postHeight = 0.35f;
const Vec3 postFoot(0.15f, -0.1f, 0);

/// With a block on it, as high as the post.
Mesh bareFloor() {
    Mesh mesh = test::sheet({-1.6f, -1.6f, 0}, {3.2f, 0, 0}, {0, 3.2f, 0}, 60, 60);
    test::append(mesh, test::box({-0.6f, 0.4f, 0}, {-0.4f, 0.6f, postHeight}, 12));
    return mesh;
}
Mesh postOf() {
    return test::box(postFoot - Vec3(postHalf, postHalf, 0), postFoot + Vec3(postHalf, postHalf, postHeight), 6);
}

/// What the post and the floor look like at a place.
Rgb shownOnPost(const Vec3& p) {
    if (p.z > 1e-3f) return Rgb(0.1f, 0.16f, 0.3f) * (1 + 2 * p.z);
    const bool dark = std::sin(17 * p.x + 5 * p.y) * std::sin(16 * p.y - 3 * p.x) > 0.5f;
    return Rgb(0.5f, 0.4f, 0.25f) * (dark ? 0.3f : 1.0f);
}

/// Photographs of one world, and what parts another lacks.
struct PostWorld {
    Capture capture;
    Scene scene;
    RadianceSamples samples;

    PostWorld(const Mesh& photographed, const Mesh& mesh, int views = 10) {
        const Scene real = test::sceneOf(photographed);
        capture.mesh = mesh;
        scene = test::sceneOf(mesh);
        for (int i = 0; i < views; ++i) {
            const double turn = 2 * piD * i / views;
            const Camera camera = test::cameraAt({1.5 * std::cos(turn), 1.5 * std::sin(turn), i % 2 ? 1.0 : 0.6},
                                                 {0, 0, 0.1}, 240, 180, 220);
            capture.views.push_back(
                test::pointPhotograph(real, camera, [](const Hit& hit, const Vec3& p, const Vec3& d) {
                    const Rgb sky(0.3f + 0.2f * std::sin(5 * d.x), 0.4f, 0.3f + 0.2f * std::sin(4 * d.y));
                    return hit ? shownOnPost(p) : sky;
                }));
        }
        Progress progress;
        samples = gatherRadiance(capture, scene, {}, progress);
    }

    MissingParts missing(const std::vector<uint8_t>& isLight = {}) const {
        Progress progress;
        return missingParts(scene, capture, samples,
                            isLight.empty() ? std::vector<uint8_t>(scene.mesh.vertexCount(), 0) : isLight, progress);
    }
};

Mesh floorAndPost() {
    Mesh mesh = bareFloor();
    test::append(mesh, postOf());
    return mesh;
}

TEST(MissingParts, APostIsAddedWhereThePhotographsShowIt) {
    const MissingParts found = PostWorld(floorAndPost(), bareFloor()).missing();
    ASSERT_EQ(found.parts, 1u);
    Box box;
    for (const Vec3& p : found.surface.positions) box.grow(p);
    for (int k = 0; k < 2; ++k) {
        EXPECT_NEAR(box.centre()[k], postFoot[k], 0.004f);
        EXPECT_NEAR(box.size()[k], 2 * postHalf, 0.018f);
    }
    EXPECT_LT(box.min.z, 0.03f);
    EXPECT_NEAR(box.max.z, postHeight, 0.015f);
    // Its sides face outwards.
    const Mesh mesh{found.surface.positions, {}, found.surface.triangles};
    size_t outwards = 0;
    for (uint32_t t = 0; t < mesh.triangles.size(); ++t) {
        const Vec3 p = mesh.positions[mesh.triangles[t][0]] - box.centre(), n = mesh.faceNormal(t);
        outwards += p.x * n.x + p.y * n.y > -0.5f * postHalf * std::abs(n.z);
    }
    EXPECT_GT(outwards, 0.9 * double(mesh.triangles.size()));
}

TEST(MissingParts, NothingIsMissingFromAWholeMesh) {
    EXPECT_EQ(PostWorld(floorAndPost(), floorAndPost()).missing().parts, 0u);
    EXPECT_EQ(PostWorld(bareFloor(), bareFloor()).missing().parts, 0u);
}

TEST(MissingParts, NothingStandsBeforeAMeshThatIsWrong) {
    // A bulge that photographs do not show: they differ on it, and on all that could stand before it.
    Mesh mesh = bareFloor();
    test::append(mesh, test::box({-0.3f, -0.5f, 0.001f}, {0.5f, 0.3f, 0.15f}, 12));
    EXPECT_EQ(PostWorld(bareFloor(), mesh).missing().parts, 0u);
}

TEST(MissingParts, NothingIsAddedToAMeshThatIsWrongAllOver) {
    // The floor lies too low, and photographs that show it agree on none of its places.
    Mesh low = bareFloor();
    for (Vec3& p : low.positions) p.z -= 0.15f;
    EXPECT_EQ(PostWorld(floorAndPost(), low).missing().parts, 0u);
}

TEST(MissingParts, ThreeViewsTellNothing) { EXPECT_EQ(PostWorld(floorAndPost(), bareFloor(), 3).missing().parts, 0u); }

TEST(MissingParts, WhatNoViewSeesMayLieFarAway) {
    Mesh mesh = bareFloor();
    test::append(mesh, test::sheet({4e4f, 4e4f, 4e4f}, {0.1f, 0, 0}, {0, 0.1f, 0}, 1, 1));
    EXPECT_EQ(PostWorld(floorAndPost(), mesh).missing().parts, 1u);
}

TEST(MissingParts, NothingIsSaidBesideLights) {
    const PostWorld world(floorAndPost(), bareFloor());
    EXPECT_EQ(world.missing(std::vector<uint8_t>(world.scene.mesh.vertexCount(), 1)).parts, 0u);
}

}  // namespace
}  // namespace relamp
