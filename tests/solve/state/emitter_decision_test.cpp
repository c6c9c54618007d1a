#include "solve/state/emitter_decision.h"

#include <gtest/gtest.h>

#include <tuple>

#include "support/shapes.h"
#include "transport/incident.h"

namespace relamp {
namespace {

/// A floor with two patches above it: one that shines by itself, and one that the other light explains.
struct TwoPatches {
    Scene scene;
    EmitterClusters clusters;
    TwoPatches() {
        Mesh mesh = test::sheet({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, 4, 4);
        const std::vector<uint32_t> bright = test::append(mesh, test::squareAbove(0.2f, -0.5f, 0, 1)),
                                    dim = test::append(mesh, test::squareAbove(0.2f, 0.5f, 0, 1));
        scene = test::sceneOf(mesh);
        clusters.emitters.push_back(cluster("emitter-1", bright, Rgb(50)));
        clusters.candidates.push_back(cluster("emitter-2", dim, Rgb(2)));
        indexEmitters(scene, clusters);
    }
    EmitterCluster cluster(const char* id, const std::vector<uint32_t>& triangles, const Rgb& radiance) const {
        EmitterCluster c;
        c.id = id;
        c.triangles = triangles;
        c.radiance = radiance;
        c.area = 0.04f;
        std::vector<uint8_t> taken(scene.mesh.vertexCount(), 0);
        for (uint32_t t : triangles)
            for (uint32_t v : scene.mesh.triangles[t])
                if (!taken[v]) taken[v] = 1, c.vertices.push_back(v);
        return c;
    }
};

TEST(EmitterDecision, CandidatesTakePartUntilTheyAreJudged) {
    const TwoPatches p;
    const EmitterDecision d = EmitterDecision::of(p.scene, p.clusters, true);
    ASSERT_EQ(d.clusters.emitters.size(), 2u);
    EXPECT_EQ(d.clusters.emitters[0].id, "emitter-1") << "strongest first";
    EXPECT_EQ(d.suspect, (std::vector<uint8_t>{0, 1}));
    EXPECT_EQ(d.surfaces.size(), 2u);
    const std::vector<uint8_t> skip = d.skip();
    EXPECT_EQ(std::count(skip.begin(), skip.end(), 1), 8);
    EXPECT_TRUE(EmitterDecision::of(p.scene, p.clusters, false).clusters.emitters.empty());
}

/// Judges where each vertex gets all of an environment of this radiance and nothing else; whether anything changed.
bool judgedUnder(EmitterDecision& d, const TwoPatches& p, float environment) {
    Capture capture;
    RadianceSamples samples;
    samples.start.assign(p.scene.mesh.vertexCount() + 1, 0);
    SolveOptions options;
    PlanChoices choices;
    Progress progress;
    const SolveInput in{capture, p.scene, samples, options, choices, progress};
    Lighting light;
    light.leaves = LightLeaves::uniform(0);
    light.leafRadiance = {Rgb(environment)};
    light.emitterRadiance = {Rgb(50), Rgb(2)};
    return d.judge(in, light, [](const std::vector<uint32_t>& vertices) {
        InfluenceMatrix rows{vertices.size(), 3, {}};
        for (size_t i = 0; i < vertices.size(); ++i) rows.values.insert(rows.values.end(), {1, 0, 0});
        return rows;
    });
}

TEST(EmitterDecision, RejectsWhatTheOtherLightsExplain) {
    const TwoPatches p;
    EmitterDecision d = EmitterDecision::of(p.scene, p.clusters, true);
    // 2 of 2.5 is an albedo of 0.8, 50 of 2.5 is none.
    EXPECT_TRUE(judgedUnder(d, p, 2.5f));
    ASSERT_EQ(d.clusters.emitters.size(), 1u);
    EXPECT_EQ(d.clusters.emitters[0].id, "emitter-1");
    EXPECT_NEAR(d.clusters.emitters[0].evidence.demandedAlbedo, 20, 1e-3);
    ASSERT_EQ(d.clusters.rejected.size(), 1u);
    EXPECT_NEAR(d.clusters.rejected[0].evidence.demandedAlbedo, 0.8, 1e-3);
    EXPECT_EQ(d.surfaces.size(), 1u);
    EXPECT_FALSE(judgedUnder(d, p, 2.5f)) << "nothing is suspect any more";
}

TEST(EmitterDecision, TheBrighterACandidateTheLessMayReflect) {
    // Contrast with the scene, albedo that reflection would need, whether it is a light.
    const std::vector<std::tuple<float, float, bool>> cases{{1, 2.4f, false},   {1, 2.6f, true},  {2.4f, 1.9f, false},
                                                            {2.4f, 2.4f, true}, {3, 1.9f, false}, {3, 2.1f, true},
                                                            {5, 1.4f, false},   {5, 1.6f, true}};
    for (const auto& [contrast, albedo, isLight] : cases) {
        TwoPatches p;
        p.clusters.candidates[0].evidence.sceneContrast = contrast;
        EmitterDecision d = EmitterDecision::of(p.scene, p.clusters, true);
        EXPECT_NE(judgedUnder(d, p, 2 / albedo), isLight) << contrast << ' ' << albedo;
    }
}

TEST(EmitterDecision, RefusesACheckpointOfAnotherMesh) {
    TwoPatches p;
    p.clusters.emitters[0].vertices.push_back(100000);
    EXPECT_THROW(EmitterDecision::of(p.scene, p.clusters, std::vector<uint8_t>{0}), Error);
}

}  // namespace
}  // namespace relamp
