// What of a surface one emitter is.
#include "clusters/patch_extent.h"

#include <gtest/gtest.h>

#include "clusters/photographed_light.h"

namespace relamp {
namespace {

TEST(PatchExtent, APatchTakesWhatIsHiddenAndNotWhatPhotographsShowDark) {
    const Scene scene = test::sceneOf(test::sheet({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, 20, 20));
    std::vector<VertexRadiance> seen(scene.mesh.vertexCount());
    std::vector<float> glimpses(seen.size(), -1);
    EmitterCluster cluster;
    cluster.radiance = test::light;
    std::vector<uint32_t> expected;
    for (uint32_t v = 0; v < seen.size(); ++v) {
        const float x = scene.mesh.positions[v].x;
        if (x < 0.5f) {
            seen[v] = {test::light, 0, 1};
            cluster.vertices.push_back(v);
        } else if (x > 0.8f) {
            glimpses[v] = 0.2f * maxChannel(test::light);
        }
        if (x <= 0.8f) expected.push_back(v);
    }
    complete(scene, seen, glimpses, std::vector<uint8_t>(seen.size(), 0), cluster);
    EXPECT_EQ(cluster.vertices, expected);
}

TEST(PatchExtent, GlimpsesShowAThinStandBelowALight) {
    const Mesh stand = test::box({-0.008f, -0.008f, 0}, {0.008f, 0.008f, 0.3f}, 12);
    const Mesh box = test::boxOf({0, 0, 0.4f}, {0.08f, 0.08f, 0.1f});
    const test::PhotographedLight world(box, box, stand);
    const std::vector<VertexRadiance> seen(world.scene.mesh.vertexCount());
    const std::vector<float> glimpses = glimpsesOf(world.scene, world.capture, world.samples, seen);
    size_t dark = 0, bright = 0, hidden = 0;
    for (size_t v = 0; v < glimpses.size(); ++v) {
        const Vec3 p = world.scene.mesh.positions[v];
        if (std::abs(p.x) > 0.1f || std::abs(p.y) > 0.1f || p.z < 0.02f) continue;
        if (p.z < 0.25f && glimpses[v] >= 0) {
            EXPECT_LT(glimpses[v], 1) << p.z;
            ++dark;
        }
        if (p.z > 0.32f && glimpses[v] >= 0) {
            EXPECT_NEAR(glimpses[v], maxChannel(test::light), 1);
            ++bright;
        }
        // The underside of the box.
        if (p.z < 0.301f && p.z > 0.299f && std::abs(p.x) < 0.06f && std::abs(p.y) < 0.06f && std::abs(p.x) > 0.02f)
            hidden += glimpses[v] < 0;
    }
    EXPECT_GT(dark, 50u);
    EXPECT_GT(bright, 100u);
    EXPECT_GT(hidden, 5u);
    std::vector<VertexRadiance> observed = seen;
    for (VertexRadiance& s : observed) s.weight = 1;
    const std::vector<float> none = glimpsesOf(world.scene, world.capture, world.samples, observed);
    EXPECT_EQ(*std::max_element(none.begin(), none.end()), -1) << "what is observed needs none";
}

}  // namespace
}  // namespace relamp
