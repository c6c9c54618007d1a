#include "clusters/emission_pattern.h"

#include <gtest/gtest.h>

#include "clusters/patches.h"
#include "radiance/gather.h"
#include "report/stress_world.h"
#include "support/shapes.h"
#include "transport/near_field.h"

namespace relamp {
namespace {

const Vec3 up(0, 0, 1);

/// A sheet of 1 x 0.5 m that faces down.
Mesh panel(int cuts = 20) { return test::sheet({0, 0, 1}, {0, 0.5f, 0}, {1, 0, 0}, cuts, cuts); }

EmitterCluster clusterOf(const Mesh& mesh, float uniformity) {
    EmitterCluster cluster;
    for (uint32_t t = 0; t < mesh.triangles.size(); ++t) cluster.triangles.push_back(t);
    for (uint32_t v = 0; v < mesh.vertexCount(); ++v) cluster.vertices.push_back(v);
    cluster.radiance = Rgb(10, 8, 4);
    cluster.evidence.uniformity = uniformity;
    return cluster;
}

/// What photographs of the world show of its emitter, which must be found as one.
EmitterCluster onlyEmitter(const StressScene& world) {
    Progress progress;
    const Capture capture = paintStressScene(world, progress).capture;
    const Scene scene = buildScene(capture.mesh, progress);
    EmitterClusters found = clusterEmitters(scene, capture, gatherRadiance(capture, scene, {}, progress), {}, progress);
    found.emitters.insert(found.emitters.end(), found.candidates.begin(), found.candidates.end());
    EXPECT_EQ(found.emitters.size(), 1u);
    return found.emitters.empty() ? EmitterCluster() : found.emitters[0];
}

TEST(EmissionPattern, IsAsExactAsAGradientAndKeepsItsBorderBeyond) {
    std::vector<Vec3> points;
    std::vector<float> levels;
    for (int i = 0; i <= 30; ++i)
        for (int j = 0; j <= 15; ++j) {
            points.push_back({i / 30.0f, 0, j / 30.0f});
            levels.push_back(0.4f + 1.2f * points.back().x);
        }
    const EmissionPattern pattern(points, levels);
    for (const float x : {0.0f, 0.13f, 0.5f, 0.77f, 1.0f})
        EXPECT_NEAR(pattern.at({x, 0.001f, 0.21f}), 0.4f + 1.2f * x, 0.02f) << x;
    EXPECT_NEAR(pattern.at({7, 3, -2}), 1.6f, 0.02f);
    EXPECT_EQ(EmissionPattern({Vec3(1)}, {1.5f}).at({9, 9, 9}), 1.5f);
    EXPECT_EQ(EmissionPattern({}, {}).at({0, 0, 0}), 1);
}

TEST(EmissionPattern, OfAClusterHasTheMeanOneAndForgetsWhatItsBorderShows) {
    // The emitter is the left part of a sheet: three of its sides are the mesh's rim, one borders on the rest.
    const Mesh mesh = panel();
    Progress progress;
    const Scene scene = buildScene(mesh, progress);
    EmitterCluster cluster;
    const auto emits = [&](uint32_t v) { return mesh.positions[v].x < 0.71f; };
    for (uint32_t v = 0; v < mesh.vertexCount(); ++v)
        if (emits(v)) cluster.vertices.push_back(v);
    for (uint32_t t = 0; t < mesh.triangles.size(); ++t)
        if (std::all_of(mesh.triangles[t].begin(), mesh.triangles[t].end(), emits)) cluster.triangles.push_back(t);
    cluster.radiance = Rgb(10, 8, 4);
    cluster.evidence.uniformity = 0.3f;
    std::vector<VertexRadiance> seen(mesh.vertexCount());
    for (size_t v = 0; v < seen.size(); ++v) {
        const Vec3 p = mesh.positions[v];
        const bool border = p.x < 1e-4f || p.x > 0.69f || p.y < 1e-4f || p.y > 0.5f - 1e-4f;
        // Brighter towards +X; what its border shows is mostly the dark behind it.
        seen[v].radiance = cluster.radiance * (border ? 0.1f : 1 + p.x);
        seen[v].weight = v % 17 == 5 ? 0.0f : 1.0f;
    }
    takeEmissionPattern(scene, seen, cluster);
    ASSERT_EQ(cluster.level.size(), cluster.vertices.size());
    ASSERT_TRUE(cluster.pattern);
    std::vector<float> levelOf(mesh.vertexCount(), 0);
    for (size_t i = 0; i < cluster.vertices.size(); ++i) levelOf[cluster.vertices[i]] = cluster.level[i];
    double mean = 0, area = 0;
    for (const uint32_t t : cluster.triangles)
        for (const uint32_t v : mesh.triangles[t]) {
            mean += double(mesh.triangleArea(t)) / 3 * double(levelOf[v]);
            area += double(mesh.triangleArea(t)) / 3;
        }
    EXPECT_NEAR(mean / area, 1, 1e-5);
    const float whole = cluster.radiance.x / 10;  // mean of 1 + x
    EXPECT_NEAR(whole, 1.35f, 0.02f);
    for (const float x : {0.0f, 0.2f, 0.5f, 0.7f})
        for (const float y : {0.0f, 0.25f, 0.5f})
            EXPECT_NEAR(cluster.pattern->at({x, y, 1}) * whole, 1 + x, 0.04f) << x << " " << y;
}

TEST(EmissionPattern, OfVeryManyVerticesRestsOnSomeOfThem) {
    std::vector<Vec3> points;
    std::vector<float> levels;
    for (int i = 0; i < 90000; ++i) {
        points.push_back({float(i % 300) / 300, float(i / 300) / 300, 0});
        levels.push_back(0.5f + points.back().x);
    }
    const EmissionPattern pattern(points, levels);
    for (const float x : {0.1f, 0.5f, 0.9f}) EXPECT_NEAR(pattern.at({x, 0.4f, 0}), 0.5f + x, 0.02f);
}

TEST(EmissionPattern, IsLeftOutWhereAnEmitterShinesEvenlyOrIsClipped) {
    const Mesh mesh = panel();
    Progress progress;
    const Scene scene = buildScene(mesh, progress);
    std::vector<VertexRadiance> seen(mesh.vertexCount());
    for (size_t v = 0; v < seen.size(); ++v) seen[v] = {Rgb(10, 8, 4) * (1 + mesh.positions[v].x), 0, 1};
    const auto has = [&](EmitterCluster cluster) {
        takeEmissionPattern(scene, seen, cluster);
        return bool(cluster.pattern);
    };
    EXPECT_TRUE(has(clusterOf(mesh, 0.3f)));
    EXPECT_FALSE(has(clusterOf(mesh, 0.05f)));
    EmitterCluster cluster = clusterOf(mesh, 0.3f);
    cluster.evidence.clippedFraction = 0.2f;
    EXPECT_FALSE(has(cluster));
    cluster = clusterOf(mesh, 0.3f);
    cluster.fitted = true;
    EXPECT_FALSE(has(cluster));
    // Noise alone is gone once neighbours are averaged.
    for (size_t v = 0; v < seen.size(); ++v) seen[v].radiance = Rgb(10, 8, 4) * (v % 2 ? 1.07f : 0.93f);
    EXPECT_FALSE(has(clusterOf(mesh, 0.1f)));
}

TEST(EmissionPattern, WeighsTheFormFactorOfEachPart) {
    Mesh mesh = panel(12);
    EmitterCluster cluster = clusterOf(mesh, 0.3f);
    for (const uint32_t v : cluster.vertices) cluster.level.push_back(0.2f + 1.6f * mesh.positions[v].x);
    rebuildPattern(mesh, cluster);
    const uint32_t vertex = uint32_t(mesh.vertexCount());
    test::append(mesh, test::sheet({0.2f, 0.1f, 0}, {0.1f, 0, 0}, {0, 0.1f, 0}, 1, 1));
    Progress progress;
    const Scene scene = buildScene(mesh, progress);
    double exact = 0;
    for (const uint32_t t : cluster.triangles) {
        const auto& [a, b, c] = mesh.triangles[t];
        const std::array<Vec3, 3> corners{mesh.positions[a], mesh.positions[b], mesh.positions[c]};
        exact += double(triangleFormFactor(mesh.positions[vertex], up, corners, false)) *
                 (0.2 + 1.6 * double(corners[0].x + corners[1].x + corners[2].x) / 3);
    }
    std::vector<EmitterSample> samples;
    sampleEmitter(scene, emitterSurface(mesh, cluster), mesh.positions[vertex], up, 1024, 1, samples);
    double sampled = 0;
    for (const EmitterSample& s : samples) sampled += double(s.formFactor * s.visible * s.level);
    EXPECT_NEAR(sampled / exact, 1, 0.01);
    EmitterClusters clusters;
    clusters.emitters.push_back(cluster);
    EXPECT_NEAR(double(computeNearField(scene, clusters, {}, progress).at(vertex, 0)) / exact, 1, 0.04);
}

TEST(EmissionPattern, OfAPaintedEmitterIsWhatWasPainted) {
    StressScene world;
    world.emitters = {{{0.2f, 0.2f, 1.1f}, 0.5f, Rgb(30), 5}};
    Progress progress;
    const PaintedWorld painted = paintStressScene(world, progress);
    const EmitterCluster emitter = onlyEmitter(world);
    ASSERT_TRUE(emitter.pattern);
    EXPECT_NEAR(emitter.radiance.x, 30, 1.5f);
    for (const EmitterCluster& strip : painted.emitters.emitters)
        EXPECT_NEAR(emitter.radiance.x * emitter.pattern->at(strip.centroid), strip.radiance.x, 0.07f * 50)
            << strip.centroid.x << " " << strip.centroid.y;
}

TEST(EmissionPattern, AStepInTheMiddleOfAnUnevenEmitterIsNoEmitterByItself) {
    StressScene world;
    world.emitters = {{{0.35f, 0.25f, 1.15f}, 0.4f, Rgb(40), 20}};
    const EmitterCluster emitter = onlyEmitter(world);
    EXPECT_NEAR(emitter.area, 0.16f, 0.01f);
    EXPECT_NEAR(emitter.radiance.x, 40, 2);
    EXPECT_TRUE(emitter.pattern);
}

}  // namespace
}  // namespace relamp
