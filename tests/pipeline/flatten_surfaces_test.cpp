#include "pipeline/flatten_surfaces.h"

#include <gtest/gtest.h>

#include "pipeline/pipeline.h"
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

}  // namespace
}  // namespace relamp
