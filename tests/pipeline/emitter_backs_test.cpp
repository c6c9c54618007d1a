// Lights that are sheets: what the mesh lacks behind them, and whether they shine to that side too.
#include "pipeline/emitter_backs.h"

#include <gtest/gtest.h>

#include <numeric>

#include "clusters/shining_sides.h"
#include "pipeline/pipeline.h"
#include "support/known_world.h"

namespace relamp {
namespace {

EmitterCluster emitterOf(const Scene& scene, std::vector<uint32_t> triangles) {
    EmitterCluster e;
    e.triangles = std::move(triangles);
    for (const uint32_t t : e.triangles)
        e.vertices.insert(e.vertices.end(), scene.mesh.triangles[t].begin(), scene.mesh.triangles[t].end());
    std::sort(e.vertices.begin(), e.vertices.end());
    e.vertices.erase(std::unique(e.vertices.begin(), e.vertices.end()), e.vertices.end());
    return e;
}

/// The known world, as far as the emitters are known.
struct PreparedWorld {
    test::TemporaryFolder folder;
    test::KnownWorld world = test::paintKnownWorld(folder / "world", true, 8, 30);
    Progress progress;
    PipelineOptions options = draft();
    Capture capture = loadCapture(folder / "world", options.load, progress);
    StageMeter meter{progress};
    Prepared prepared = prepare(capture, options, meter, progress);

    static PipelineOptions draft() {
        PipelineOptions options;
        options.solve = solveOptionsFor("draft");
        return options;
    }
};

TEST(EmitterBacks, ASheetIsOpenBehindAndABodyIsNot) {
    Mesh mesh = test::box({0, 0, 0}, {0.3f, 0.3f, 0.02f}, 3);
    std::vector<uint32_t> body(mesh.triangles.size());
    std::iota(body.begin(), body.end(), 0u);
    const std::vector<uint32_t> sheet = test::append(mesh, test::squareAbove(0.3f, 2, 0, 1, 4));
    test::append(mesh, test::sheet({-4, -4, 3}, {8, 0, 0}, {0, 8, 0}));  // faces away from it
    const Scene underRoof = test::sceneOf(mesh);
    EXPECT_EQ(openBehind(underRoof, emitterOf(underRoof, body)), 0);
    EXPECT_EQ(openBehind(underRoof, emitterOf(underRoof, sheet)), 0) << "a wall of some thickness is a body";
    mesh.triangles.resize(mesh.triangles.size() - 2);
    test::append(mesh, test::squareAbove(8, 0, 0, 3));  // faces it
    const Scene underCeiling = test::sceneOf(mesh);
    EXPECT_EQ(openBehind(underCeiling, emitterOf(underCeiling, sheet)), 1);
    EXPECT_EQ(openBehind(underCeiling, emitterOf(underCeiling, body)), 0);
}

TEST(EmitterBacks, ShineWherePhotographsSaySo) {
    PreparedWorld w;
    const Prepared& p = w.prepared;
    ASSERT_EQ(p.clusters.emitters.size(), 1u);
    EXPECT_EQ(openBehind(*p.scene, p.clusters.emitters[0]), 1);
    // Its back lights nothing here: that says nothing, and it has none.
    EXPECT_TRUE(shiningToBothSides(*p.scene, *p.samples, p.clusters, w.options.solve, w.progress).empty());
    // A mesh that has its upper side alone: the light on the floor then comes from the back.
    Mesh turned = w.capture.mesh;
    for (const uint32_t t : p.clusters.emitters[0].triangles) std::swap(turned.triangles[t][1], turned.triangles[t][2]);
    for (const uint32_t v : p.clusters.emitters[0].vertices) turned.normals[v] = -turned.normals[v];
    const Scene fromAbove = buildScene(turned, w.progress);
    const std::vector<uint32_t> both =
        shiningToBothSides(fromAbove, *p.samples, p.clusters, w.options.solve, w.progress);
    EXPECT_EQ(both, p.clusters.emitters[0].vertices);
    EmitterClusters clusters = p.clusters;
    letBacksShine({}, clusters);
    EXPECT_FALSE(clusters.emitters[0].twoSided);
    letBacksShine(both, clusters);
    EXPECT_TRUE(clusters.emitters[0].twoSided);
}

TEST(EmitterSkins, ShineWherePhotographsSaySo) {
    PreparedWorld w;
    const Prepared& p = w.prepared;
    ASSERT_EQ(p.clusters.emitters.size(), 1u);
    EXPECT_TRUE(shiningSkins(*p.scene, *p.samples, p.clusters, w.options.solve, w.progress).empty())
        << "all of it shines";
    // A stripe of the light is a surface that no photograph shows.
    std::vector<uint8_t> hidden(p.scene->mesh.vertexCount(), 0);
    EmitterClusters half = p.clusters;
    EmitterCluster& light = half.emitters[0];
    const std::vector<uint32_t> whole = light.vertices;
    for (const uint32_t v : whole)
        hidden[v] = std::abs((p.scene->mesh.positions[v] - light.centroid).x) < 0.1f * w.world.emitterSide;
    std::erase_if(light.vertices, [&](uint32_t v) { return hidden[v] != 0; });
    std::erase_if(light.triangles, [&](uint32_t t) {
        const Triangle& c = p.scene->mesh.triangles[t];
        return hidden[c[0]] || hidden[c[1]] || hidden[c[2]];
    });
    measureTriangles(*p.scene, light);
    indexEmitters(*p.scene, half);
    ASSERT_LT(half.emitters[0].area, 0.9f * p.clusters.emitters[0].area);
    RadianceSamples samples = *p.samples;
    samples.samples.clear();
    for (uint32_t v = 0; v < hidden.size(); ++v) {
        samples.start[v] = uint32_t(samples.samples.size());
        if (hidden[v]) continue;
        for (uint32_t k = p.samples->start[v]; k < p.samples->start[v + 1]; ++k)
            samples.samples.push_back(p.samples->samples[k]);
    }
    samples.start.back() = uint32_t(samples.samples.size());
    const std::vector<uint32_t> skin = shiningSkins(*p.scene, samples, half, w.options.solve, w.progress);
    std::vector<uint32_t> expected;
    for (uint32_t v = 0; v < hidden.size(); ++v)
        if (hidden[v]) expected.push_back(v);
    EXPECT_EQ(skin, expected);
    letSidesShine(*p.scene, skin, half);
    EXPECT_EQ(half.emitters[0].vertices, whole);
}

}  // namespace
}  // namespace relamp
