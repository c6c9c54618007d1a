#include "pipeline/flatten_surfaces.h"

#include <gtest/gtest.h>

#include "pipeline/pipeline.h"
#include "support/before_background.h"
#include "support/known_world.h"

namespace relamp {
namespace {

/// Largest height of the floor's vertices, metres.
float highest(const Mesh& mesh, size_t floorVertices) {
    float most = 0;
    for (size_t v = 0; v < floorVertices; ++v) most = std::max(most, std::abs(mesh.positions[v].z));
    return most;
}

TEST(FlattenSurfaces, TakesWavesOutOfAFloorAndLeavesAFlatOneAlone) {
    const test::TemporaryFolder folder;
    const test::KnownWorld world = test::paintKnownWorld(folder / "world", true, 8, 30);
    Progress progress;
    PipelineOptions options;
    options.solve = solveOptionsFor("draft");
    options.onlyPlan = true;
    options.plan = options.mend = options.photometric = false;
    EXPECT_TRUE(runPipeline(folder / "world", options, progress).corrections.registration.flatSteps.empty());

    Mesh wavy = world.mesh;
    for (size_t v = 0; v < world.floorVertices; ++v) {
        Vec3& p = wavy.positions[v];
        p.z += 0.004f * std::sin(9 * p.x + 1) * std::cos(8 * p.y);
    }
    wavy.normals = vertexNormalsFromFaces(wavy);
    writeVertexPly(folder / "world" / "mesh.ply", wavy, {});
    const PipelineResult result = runPipeline(folder / "world", options, progress);
    const RegistrationFix& fix = result.corrections.registration;
    ASSERT_FALSE(fix.flatSteps.empty());
    EXPECT_LT(highest(result.capture.mesh, world.floorVertices), 0.4f * highest(wavy, world.floorVertices));
    ASSERT_FALSE(result.capture.notes.empty());
    EXPECT_NE(result.capture.notes.back().find("brought onto its plane"), std::string::npos);
    // The capture read again with these displacements has the same surface.
    LoadOptions again;
    again.fix.registration = fix;
    const Mesh same = loadCapture(folder / "world", again, progress).mesh;
    EXPECT_EQ(same.positions, result.capture.mesh.positions);
    EXPECT_EQ(same.normals, result.capture.mesh.normals);
}

TEST(FlattenSurfaces, ASkirtDoesNotTiltTheTableThatItHangsOn) {
    // 1.6 m of table with waves of a millimetre; the skirt on one side slopes by 10 mm.
    const auto sheet = [](float to) { return test::sheet({-0.8f, -0.8f, 0}, {0.8f + to, 0, 0}, {0, 1.6f, 0}, 80, 60); };
    Mesh wavy = sheet(1.6f);
    for (Vec3& p : wavy.positions)
        p.z = p.x > 0.8f ? 0.0125f * (p.x - 0.8f) : 0.001f * std::sin(9 * p.x + 1) * std::cos(8 * p.y);
    const test::MeshBefore table(sheet(0.8f), wavy, test::pattern, test::wood, 110, 8);
    ASSERT_GT(table.free.size(), 1000u);
    EmitterClusters none;
    none.emitterOfVertex.assign(wavy.vertexCount(), -1);
    none.emitterOfTriangle.assign(wavy.triangles.size(), -1);
    Progress progress;
    const FlattenedSurfaces found =
        flattenSurfaces(table.capture, table.scene, table.samples, none, {}, solveOptionsFor("draft"), progress);
    ASSERT_FALSE(found.fix.empty());
    Mesh flat = wavy;
    applyRegistration(found.fix, flat);
    float most = 0, skirt = 0;
    for (size_t v = 0; v < flat.vertexCount(); ++v) {
        const Vec3& p = flat.positions[v];
        if (p.x < 0.7f) most = std::max(most, std::abs(p.z));
        if (p.x > 1) skirt = std::max(skirt, std::abs(p.z - wavy.positions[v].z));
    }
    EXPECT_LT(most, 2e-4f);
    EXPECT_EQ(skirt, 0);
}

}  // namespace
}  // namespace relamp
