#include "relight/standing_emitters.h"

#include <gtest/gtest.h>

#include <map>

#include "support/shapes.h"

namespace relamp {
namespace {

constexpr uint32_t side = 13;

/// One surface as a reconstruction has it: a floor of 1.2 m from which a body of 0.4 x 0.4 x `height` rises.
Scene floorWithBody(float height) {
    Mesh mesh = test::sheet(Vec3(0), Vec3(1.2f, 0, 0), Vec3(0, 1.2f, 0), side - 1, side - 1);
    for (Vec3& p : mesh.positions)
        if (std::abs(p.x - 0.6f) < 0.25f && std::abs(p.y - 0.6f) < 0.25f) p.z = height;
    return test::sceneOf(mesh);
}

/// The triangles that the body raises.
EmitterCluster bodyOf(const Scene& scene) {
    EmitterCluster body;
    for (uint32_t t = 0; t < scene.mesh.triangles.size(); ++t) {
        const Triangle& c = scene.mesh.triangles[t];
        bool raised = false;
        for (const uint32_t v : c) raised = raised || scene.mesh.positions[v].z > 0;
        if (!raised) continue;
        body.triangles.push_back(t);
        body.vertices.insert(body.vertices.end(), c.begin(), c.end());
        body.area += 0.5f * glm::length(glm::cross(scene.mesh.positions[c[1]] - scene.mesh.positions[c[0]],
                                                   scene.mesh.positions[c[2]] - scene.mesh.positions[c[0]]));
    }
    std::sort(body.vertices.begin(), body.vertices.end());
    body.vertices.erase(std::unique(body.vertices.begin(), body.vertices.end()), body.vertices.end());
    return body;
}

/// Edges that only one of these triangles has, or that two have in one direction.
size_t openEdges(const Mesh& mesh, const std::vector<uint32_t>& triangles) {
    std::map<std::pair<uint32_t, uint32_t>, int> count;
    for (const uint32_t t : triangles)
        for (size_t k = 0; k < 3; ++k) ++count[{mesh.triangles[t][k], mesh.triangles[t][(k + 1) % 3]}];
    size_t open = 0;
    for (const auto& [edge, times] : count) {
        const auto back = count.find({edge.second, edge.first});
        open += back == count.end() || back->second != times;
    }
    return open;
}

std::vector<uint32_t> groundOf(const ClosedMesh& closed, const EmitterCluster& body, size_t captured) {
    std::vector<uint32_t> ground;
    for (uint32_t t = 0; t < closed.mesh.triangles.size(); ++t)
        if (t < captured ? !std::binary_search(body.triangles.begin(), body.triangles.end(), t)
                         : closed.emitterOfNewTriangle[t - captured] < 0)
            ground.push_back(t);
    return ground;
}

TEST(StandingEmitters, GetAnUndersideAndLeaveAWholeFloor) {
    const Scene scene = floorWithBody(0.6f);
    const EmitterCluster body = bodyOf(scene);
    ASSERT_GT(openEdges(scene.mesh, body.triangles), 10u);
    const ClosedMesh closed = closeStandingEmitters(scene, {body}, {1});
    EXPECT_EQ(openEdges(closed.mesh, closed.emitters[0].triangles), 0u) << "the body is closed, all sides outwards";
    const std::vector<uint32_t> ground = groundOf(closed, body, scene.mesh.triangles.size());
    EXPECT_EQ(openEdges(closed.mesh, ground), 4 * (side - 1)) << "the floor ends at its own border alone";
    for (const uint32_t t : ground)
        for (const uint32_t v : closed.mesh.triangles[t]) {
            EXPECT_EQ(closed.mesh.positions[v].z, 0);
            const uint32_t origin = closed.vertexOrigin[v];
            EXPECT_FALSE(std::binary_search(body.vertices.begin(), body.vertices.end(), origin))
                << "nothing of the floor is as black as the light's own vertices";
        }
    EXPECT_FALSE(closed.untextured.empty());
}

TEST(StandingEmitters, ThatLieFlatDoNotShineBackwards) {
    const Scene scene = floorWithBody(0.01f);
    const EmitterCluster body = bodyOf(scene);
    const ClosedMesh closed = closeStandingEmitters(scene, {body}, {1});
    EXPECT_EQ(closed.emitters[0].triangles, body.triangles);
    EXPECT_EQ(openEdges(closed.mesh, groundOf(closed, body, scene.mesh.triangles.size())), 4 * (side - 1));
}

TEST(StandingEmitters, ThatStayOrEndInTheAirAreLeftAlone) {
    const Scene scene = floorWithBody(0.6f);
    const EmitterCluster body = bodyOf(scene);
    EXPECT_EQ(closeStandingEmitters(scene, {body}, {0}).mesh.triangles, scene.mesh.triangles);
    Mesh alone = scene.mesh;
    alone.triangles.clear();
    EmitterCluster all = body;
    all.triangles.clear();
    for (const uint32_t t : body.triangles) {
        all.triangles.push_back(uint32_t(alone.triangles.size()));
        alone.triangles.push_back(scene.mesh.triangles[t]);
    }
    Progress progress;
    const Scene open = buildScene(alone, progress);
    const ClosedMesh closed = closeStandingEmitters(open, {all}, {1});
    EXPECT_EQ(closed.mesh.triangles, open.mesh.triangles);
    EXPECT_EQ(closed.emitters[0].triangles, all.triangles);
}

}  // namespace
}  // namespace relamp
