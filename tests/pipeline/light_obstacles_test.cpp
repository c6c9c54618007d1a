// What may be a shadow that is not there.
#include "pipeline/light_obstacles.h"

#include <gtest/gtest.h>

#include "support/estimates.h"

namespace relamp {
namespace {

TEST(LightObstacles, ABulbsStandIsNoneAndWhatShinesAsTheBulbIs) {
    // A ball of 10 cm over the middle of a sheet of 41 x 41 vertices, 1 cm apart.
    const Scene scene = test::sceneOf(test::sheet({-0.2f, -0.2f, 0}, {0.4f, 0, 0}, {0, 0.4f, 0}, 40, 40));
    const size_t vertices = scene.mesh.vertexCount();
    EmitterClusters emitters;
    emitters.emitterOfVertex.assign(vertices, -1);
    emitters.emitterOfTriangle.assign(scene.mesh.triangles.size(), -1);
    EmitterCluster bulb;
    bulb.fitted = true;
    bulb.centroid = Vec3(0, 0, 0.12f);
    bulb.area = 4 * pi * 0.1f * 0.1f;
    bulb.radiance = Rgb(10);
    emitters.emitters.push_back(bulb);
    // Bright as the bulb where x < 0, as a white surface beside it where x > 0; one vertex is not seen.
    const uint32_t unseen = 20 * 41 + 25;
    RadianceSamples samples;
    samples.start.push_back(0);
    for (uint32_t v = 0; v < vertices; ++v) {
        if (v != unseen) samples.samples.push_back({0, Rgb(scene.mesh.positions[v].x < 0 ? 8.0f : 2.0f), 1, false});
        samples.start.push_back(uint32_t(samples.samples.size()));
    }
    const auto suspects = obstacleSuspects(scene, samples, emitters, vertices);
    ASSERT_EQ(suspects.size(), 3u);
    EXPECT_EQ(suspects[0], std::vector<uint32_t>{unseen});
    EXPECT_EQ(suspects[1], std::vector<uint32_t>{unseen});
    EXPECT_GT(suspects[2].size(), 50u);
    for (const uint32_t v : suspects[2]) {
        EXPECT_LT(glm::distance(scene.mesh.positions[v], bulb.centroid), 0.15f);
        EXPECT_TRUE(v == unseen || scene.mesh.positions[v].x < 0) << v;
    }
    // What mends added is known to be there.
    EXPECT_TRUE(obstacleSuspects(scene, samples, emitters, 0).empty());
}

}  // namespace
}  // namespace relamp
