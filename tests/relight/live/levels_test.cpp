// Levels of detail of a mesh: which vertices stand for others.
#include "relight/live/levels.h"

#include <gtest/gtest.h>

#include "support/shapes.h"

namespace relamp {
namespace {

TEST(LiveLevels, EveryVertexLiesAmongItsParents) {
    constexpr int cuts = 80;
    Mesh mesh = test::sheet({-2, -2, 0}, {4, 0, 0}, {0, 4, 0}, cuts, cuts);
    for (Vec3& p : mesh.positions) p.z = 0.2f * std::sin(2 * p.x) * std::cos(p.y);
    mesh.normals = vertexNormalsFromFaces(mesh);
    const VertexGraph graph = buildVertexGraph(mesh);
    std::vector<uint8_t> wanted(mesh.vertexCount(), 1);
    for (uint32_t v = 0; v < cuts; ++v) wanted[v] = 0;
    const LiveLevels levels(mesh, graph, wanted, 200);
    ASSERT_GE(levels.sets().size(), 3u);
    EXPECT_GE(levels.sets()[0].size(), 200u);
    std::vector<uint8_t> known(mesh.vertexCount(), 0);
    size_t count = 0, alone = 0;
    for (const std::vector<uint32_t>& set : levels.sets()) {
        for (const uint32_t v : set) {
            ASSERT_TRUE(wanted[v] && !known[v]);
            const auto parents = levels.parents(v);
            alone += parents.empty();
            if (parents.empty()) continue;
            float sum = 0;
            Vec3 place(0);
            for (const LiveLevels::Parent& p : parents) {
                ASSERT_TRUE(known[p.vertex]) << "of a coarser level";
                sum += p.weight;
                place += p.weight * mesh.positions[p.vertex];
            }
            EXPECT_NEAR(sum, 1, 1e-3f);
            const Vec3 off = place - mesh.positions[v], normal = mesh.normals[v];
            EXPECT_LT(glm::length(off - glm::dot(off, normal) * normal), 1e-3f);
            EXPECT_LT(glm::length(off), 0.05f);
        }
        for (const uint32_t v : set) known[v] = 1;
        count += set.size();
    }
    EXPECT_EQ(count, mesh.vertexCount() - cuts);
    // Those of the coarsest level, and few at the sheet's rim.
    EXPECT_LT(alone, levels.sets()[0].size() + count / 10);
}

TEST(LiveLevels, AMeshOfLonePointsHasNone) {
    Mesh mesh;
    mesh.positions.assign(500, Vec3(0));
    for (size_t v = 0; v < 500; ++v) mesh.positions[v].x = float(v);
    mesh.normals.assign(500, Vec3(0, 0, 1));
    VertexGraph graph;
    graph.start.assign(501, 0);
    EXPECT_TRUE(LiveLevels(mesh, graph, std::vector<uint8_t>(500, 1), 10).empty());
    EXPECT_TRUE(LiveLevels(mesh, graph, std::vector<uint8_t>(500, 0), 10).empty());
}

}  // namespace
}  // namespace relamp
