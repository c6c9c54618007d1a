// Normals that are off come back by the hues of a warm glow and a blue sky.
#include "pipeline/lean_normals.h"

#include <gtest/gtest.h>

#include <random>

#include "pipeline/pipeline.h"
#include "support/known_world.h"

namespace relamp {
namespace {

/// The known world, its normals leant at random.
struct LeantWorld {
    test::TemporaryFolder folder;
    test::KnownWorld world = test::paintKnownWorld(folder / "world", true, 8, 30);
    Progress progress;
    PipelineOptions options;
    Capture capture;
    std::vector<Vec3> truth;
    LeantNormals found;

    explicit LeantWorld(float lean) {
        options.solve = solveOptionsFor("draft");
        capture = loadCapture(folder / "world", options.load, progress);
        truth = capture.mesh.normals;
        std::mt19937 random(3);
        std::normal_distribution<float> normal(0, lean);
        for (Vec3& n : capture.mesh.normals)
            n = glm::normalize(n + Vec3(normal(random), normal(random), normal(random)));
        StageMeter meter{progress};
        const Prepared prepared = prepare(capture, options, meter, progress);
        found = leanNormals(*prepared.scene, *prepared.samples, prepared.clusters,
                            std::vector<uint8_t>(truth.size(), 0), options.solve, progress);
    }

    /// Mean square of what the ball's normals are off by, with the leans over without.
    double left() const {
        std::vector<Vec3> normals = capture.mesh.normals;
        for (const MeshMend::TurnedVertex& t : found.turned) normals[t.vertex] = glm::normalize(t.normal);
        double before = 0, after = 0;
        for (size_t v = world.ballBegin; v < world.ballEnd; ++v) {
            before += std::pow(double(glm::distance(capture.mesh.normals[v], truth[v])), 2);
            after += std::pow(double(glm::distance(normals[v], truth[v])), 2);
        }
        return after / before;
    }
};

TEST(LeanNormals, BringsThemNearerToTheTruth) {
    const LeantWorld world(0.06f);
    ASSERT_FALSE(world.found.turned.empty());
    EXPECT_NE(world.found.words.find("as the hues of the light show it"), std::string::npos);
    EXPECT_LT(world.left(), 0.95) << "one of two directions, where hues differ";
    for (size_t i = 1; i < world.found.turned.size(); ++i)
        EXPECT_LT(world.found.turned[i - 1].vertex, world.found.turned[i].vertex);
}

TEST(LeanNormals, LeavesTrueOnes) { EXPECT_TRUE(LeantWorld(0).found.turned.empty()); }

TEST(KnownNormals, AreThoseOfFlatSurfacesAndCreasesAndOfWhatWasAdded) {
    const Scene scene = test::sceneOf(test::sheet({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, 2, 2));
    ASSERT_EQ(scene.mesh.vertexCount(), 9u);
    RegistrationFix fix;
    fix.flatStep = 0.001f;
    fix.flatSteps = {0, 3, 0, 0, 0, 0, 0};
    MeshMend mend;
    mend.turned = {{4, {0, 0, 1}}};
    EXPECT_EQ(knownNormals(scene, 7, fix, mend), (std::vector<uint8_t>{0, 1, 0, 0, 1, 0, 0, 1, 1}));
}

}  // namespace
}  // namespace relamp
