#include "pipeline/normals_choice.h"

#include <gtest/gtest.h>

#include <random>

#include "pipeline/pipeline.h"
#include "scene/smooth_normals.h"
#include "support/known_world.h"

namespace relamp {
namespace {

TEST(SmoothedNormals, LoseTheirNoiseAndKeepCreases) {
    Mesh ball = test::ball({0, 0, 0}, 1, 40, 60);
    std::mt19937 random(1);
    std::normal_distribution<float> normal(0, 0.15f);
    const std::vector<Vec3> truth = ball.normals;
    for (Vec3& n : ball.normals) n = glm::normalize(n + Vec3(normal(random), normal(random), normal(random)));
    const auto error = [&](const std::vector<Vec3>& normals) {
        double sum = 0;
        for (size_t v = 0; v < truth.size(); ++v) sum += double(glm::distance(normals[v], truth[v]));
        return sum;
    };
    EXPECT_LT(error(smoothedNormals(ball, 6)), 0.4 * error(ball.normals));
    EXPECT_EQ(smoothedNormals(ball, 0), ball.normals);
    for (const Vec3& n : smoothedNormals(ball, 3)) EXPECT_NEAR(glm::length(n), 1, 1e-5);
    // Two faces at a right angle with a normal each.
    Mesh roof;
    roof.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 0, 1}};
    roof.triangles = {{0, 1, 2}, {0, 1, 3}};
    roof.normals = {{0, 0, 1}, {0, 0, 1}, {0, 0, 1}, {0, -1, 0}};
    const std::vector<Vec3> kept = smoothedNormals(roof, 2);
    EXPECT_GT(kept[0].z, 0.99f);
    EXPECT_LT(kept[3].y, -0.98f);
}

TEST(NormalsChoice, SmoothsWhereTheMeshIsNoisyAndOnlyThere) {
    const test::TemporaryFolder folder;
    const test::KnownWorld world = test::paintKnownWorld(folder / "world", true, 8, 30);
    Progress progress;
    PipelineOptions options;
    options.solve = solveOptionsFor("draft");
    options.onlyPlan = true;
    // The normals are chosen before and without these.
    options.plan = options.registration = options.photometric = false;
    EXPECT_EQ(runPipeline(folder / "world", options, progress).corrections.smoothedNormals, 0);
    Mesh noisy = world.mesh;
    std::mt19937 random(2);
    std::normal_distribution<float> normal(0, 0.2f);
    for (Vec3& n : noisy.normals) n = glm::normalize(n + Vec3(normal(random), normal(random), normal(random)));
    writeVertexPly(folder / "world" / "mesh.ply", noisy, {});
    const PipelineResult result = runPipeline(folder / "world", options, progress);
    EXPECT_GT(result.corrections.smoothedNormals, 0);
    ASSERT_FALSE(result.capture.notes.empty());
    EXPECT_NE(result.capture.notes.back().find("normals are noisy"), std::string::npos);
    // The capture read again with that number of rounds has the same normals.
    LoadOptions again;
    again.fix.smoothNormals = result.corrections.smoothedNormals;
    EXPECT_EQ(loadCapture(folder / "world", again, progress).mesh.normals, result.capture.mesh.normals);
    // An artist's word holds.
    options.load.fix.smoothNormals = 0;
    EXPECT_EQ(runPipeline(folder / "world", options, progress).corrections.smoothedNormals, 0);
}

}  // namespace
}  // namespace relamp
