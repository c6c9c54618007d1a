#include "solve/registration/displacement_graph.h"

#include <gtest/gtest.h>

#include "radiance/gather.h"
#include "solve/registration/edge_distance.h"
#include "support/shaken_sheet.h"

namespace relamp {
namespace {

TEST(DisplacementGraph, TakesConstantsAndSlopesOver) {
    const Scene scene = test::sceneOf(test::sheet({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, 60, 60));
    const DisplacementGraph graph = buildDisplacementGraph(scene, 0.15f);
    EXPECT_GT(graph.nodes.size(), 100u);
    EXPECT_LT(graph.nodes.size(), 400u);
    const std::vector<double> constant(graph.nodes.size(), 0.25);
    std::vector<double> slope;
    for (const uint32_t v : graph.nodes) slope.push_back(double(scene.mesh.positions[v].x));
    for (uint32_t v = 0; v < scene.mesh.vertexCount(); ++v) {
        EXPECT_NEAR(graph.at(v, constant), 0.25, 1e-6);
        EXPECT_NEAR(graph.at(v, slope), double(scene.mesh.positions[v].x), 0.12);
    }
    for (uint32_t a = 0; a < graph.nodes.size(); ++a) {
        EXPECT_FALSE(graph.neighbours[a].empty());
        for (const uint32_t b : graph.neighbours[a]) {
            EXPECT_NE(a, b);
            EXPECT_TRUE(std::binary_search(graph.neighbours[b].begin(), graph.neighbours[b].end(), a));
        }
    }
}

TEST(DisplacementGraph, KeepsSidesThatFaceAwayApart) {
    // Two sheets a millimetre apart, back to back.
    Mesh mesh = test::sheet({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, 20, 20);
    const size_t front = mesh.vertexCount();
    test::append(mesh, test::sheet({-1, -1, -0.001f}, {0, 2, 0}, {2, 0, 0}, 20, 20));
    const Scene scene = test::sceneOf(mesh);
    const DisplacementGraph graph = buildDisplacementGraph(scene, 0.3f);
    for (uint32_t v = 0; v < scene.mesh.vertexCount(); ++v) {
        for (size_t k = 0; k < 4; ++k) {
            if (graph.shares[v].weight[k] <= 0) continue;
            EXPECT_EQ(graph.nodes[graph.shares[v].node[k]] < front, v < front);
        }
    }
}

TEST(EdgeDistance, CountsPixelsFromTheRimOfASheet) {
    const test::ShakenSheet sheet;
    Progress progress;
    const RadianceSamples samples = gatherRadiance(sheet.capture, sheet.scene, {}, progress);
    const View& view = sheet.capture.views[0];
    const std::vector<uint8_t> distance = edgeDistance(view, samples.geometry[0], sheet.scene);
    const auto at = [&](const DVec3& p) {
        const Vec2 pixel = *view.camera.project(p);
        return int(distance[size_t(pixel.y) * size_t(view.image.width) + size_t(pixel.x)]);
    };
    EXPECT_GT(at({0, 0, 0}), 20);
    EXPECT_LE(at({-0.999, 0, 0}), 1);
    EXPECT_EQ(at({-1.3, 0, 0}), 0) << "no surface";
    // A tenth of a metre inside the far rim.
    const Vec2 rim = *view.camera.project({-1, 0, 0}), inside = *view.camera.project({-0.9, 0, 0});
    EXPECT_NEAR(at({-0.9, 0, 0}), glm::length(inside - rim), 2);
}

}  // namespace
}  // namespace relamp
