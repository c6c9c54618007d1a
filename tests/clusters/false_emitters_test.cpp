// What meshes that are not exact make of an emitter: several patches, patches past its edge, and surfaces that it
// lights brightly.
#include "clusters/false_emitters.h"

#include <gtest/gtest.h>

#include "radiance/gather.h"
#include "support/estimates.h"

namespace relamp {
namespace {

/// A cluster of the triangles whose corners all satisfy `inside`.
template <class Inside>
EmitterCluster clusterOf(const Scene& scene, const Rgb& radiance, Inside&& inside) {
    EmitterCluster cluster;
    cluster.radiance = radiance;
    for (uint32_t v = 0; v < scene.mesh.vertexCount(); ++v)
        if (inside(scene.mesh.positions[v])) cluster.vertices.push_back(v);
    Vec3 sum(0);
    for (uint32_t t = 0; t < scene.mesh.triangles.size(); ++t) {
        const Triangle& c = scene.mesh.triangles[t];
        if (!inside(scene.mesh.positions[c[0]]) || !inside(scene.mesh.positions[c[1]]) ||
            !inside(scene.mesh.positions[c[2]]))
            continue;
        cluster.triangles.push_back(t);
        const float area = scene.mesh.triangleArea(t);
        cluster.area += area;
        sum += area / 3 * (scene.mesh.positions[c[0]] + scene.mesh.positions[c[1]] + scene.mesh.positions[c[2]]);
    }
    cluster.centroid = sum / cluster.area;
    return cluster;
}

/// A floor of 4 x 4 m, and an emitter of 0.4 x 0.4 m that looks down on it from 0.5 m.
Scene roomScene() {
    Mesh mesh = test::sheet({-2, -2, 0}, {4, 0, 0}, {0, 4, 0}, 80, 80);
    test::append(mesh, test::squareAbove(0.4f, 0, 0, 0.5f, 8));
    return test::sceneOf(std::move(mesh));
}
bool onEmitter(const Vec3& p) { return p.z > 0.4f; }

TEST(FalseEmitters, PatchesOfOneRadianceAHairApartAreOneEmitter) {
    const Scene scene = test::sceneOf(test::sheet({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, 200, 200));
    const auto strip = [&](float from, float to, const Rgb& radiance) {
        return clusterOf(scene, radiance,
                         [&](const Vec3& p) { return p.x > from && p.x < to && std::abs(p.y) < 0.2f; });
    };
    // 1 cm apart where the scene is 2.8 m across; then 10 cm; then of another radiance.
    std::vector<EmitterCluster> emitters{strip(0, 0.205f, Rgb(9, 5, 4)), strip(0.205f, 0.3f, Rgb(9.01f, 5, 4)),
                                         strip(0.4f, 0.5f, Rgb(9, 5, 4)), strip(-0.1f, -0.005f, Rgb(9, 7, 4))};
    const float whole = emitters[0].area + emitters[1].area;
    joinSplitEmitters(scene, emitters);
    ASSERT_EQ(emitters.size(), 3u);
    const auto joined = std::find_if(emitters.begin(), emitters.end(),
                                     [&](const EmitterCluster& e) { return std::abs(e.area - whole) < 1e-6f; });
    ASSERT_NE(joined, emitters.end());
    EXPECT_NEAR(joined->centroid.x, 0.15f, 0.01f);
    EXPECT_TRUE(std::is_sorted(joined->triangles.begin(), joined->triangles.end()));
}

TEST(FalseEmitters, ABlurredRimIsPartOfItsEmitterAndADimmerLightIsNot) {
    const Scene scene = test::sceneOf(test::sheet({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, 200, 200));
    const auto strip = [&](float from, float to, const Rgb& radiance) {
        return clusterOf(scene, radiance,
                         [&](const Vec3& p) { return p.x > from && p.x < to && std::abs(p.y) < 0.2f; });
    };
    const Rgb bright(8, 5, 3);
    std::vector<EmitterCluster> emitters{strip(0, 0.4f, bright)};
    const float whole = emitters[0].area;
    // The rim of 2 cm at 0.8 of its radiance; then one as dim as a surface, one of another hue, one far off, a large
    // one.
    std::vector<EmitterCluster> candidates{strip(0.395f, 0.425f, 0.8f * bright), strip(0.395f, 0.425f, 0.2f * bright),
                                           strip(0.395f, 0.425f, Rgb(6, 5, 3)), strip(0.495f, 0.525f, 0.8f * bright),
                                           strip(-0.2f, 0.005f, 0.8f * bright)};
    const float rim = candidates[0].area;
    joinBlurredParts(scene, emitters, candidates);
    EXPECT_EQ(candidates.size(), 4u);
    EXPECT_NEAR(emitters[0].area, whole + rim, 1e-6f);
    EXPECT_EQ(emitters[0].radiance, bright);
}

TEST(FalseEmitters, WhatAnEmitterLightsWithAPlausibleAlbedoIsNamedAndAnEmitterOfItsOwnIsNot) {
    const Scene scene = roomScene();
    const std::vector<EmitterCluster> emitters{clusterOf(scene, Rgb(100, 80, 60), onEmitter)};
    const auto under = [](const Vec3& p) { return p.z < 0.1f && std::max(std::abs(p.x), std::abs(p.y)) < 0.06f; };
    // Right below: parallel squares of 0.4 m at 0.5 m send a fraction of about 0.17 there.
    const float half =
        albedoBesideEmitters(scene, emitters, clusterOf(scene, 0.17f * 0.5f * emitters[0].radiance, under));
    EXPECT_NEAR(half, 0.5f, 0.06f);
    EXPECT_GT(albedoBesideEmitters(scene, emitters, clusterOf(scene, 0.5f * emitters[0].radiance, under)), 2.0f);
    EXPECT_GT(albedoBesideEmitters(scene, emitters,
                                   clusterOf(scene, 0.1f * emitters[0].radiance,
                                             [](const Vec3& p) { return p.x > 1.8f && p.z < 0.1f; })),
              5.0f);
    // Of another hue than the emitter can light it with.
    EXPECT_GT(albedoBesideEmitters(scene, emitters, clusterOf(scene, Rgb(5, 5, 20), under)), 1.5f);
}

TEST(FalseEmitters, WhatShowsTheEmitterPastItsEdgeInEveryPhotographIsNoEmitter) {
    const Scene scene = roomScene();
    Capture capture;
    for (const double x : {-1.2, 1.2}) {
        View view;
        view.camera = test::cameraAt({x, -1.6, 1.2}, {0, 0, 0.3}, 160, 120, 150);
        view.image = Image(160, 120, Rgb(1));
        capture.views.push_back(view);
    }
    Progress progress;
    RadianceSamples samples = gatherRadiance(capture, scene, {}, progress);
    const EmitterCluster emitter = clusterOf(scene, Rgb(9, 5, 4), onEmitter);
    // Floor vertices whose looks are the emitter's radiance: behind the emitter's image in one case, at the camera's
    // feet in the other.
    const auto patchOf = [&](bool beside) {
        EmitterCluster patch;
        patch.radiance = emitter.radiance;
        patch.area = 0.01f;
        for (uint32_t v = 0; v < scene.mesh.vertexCount(); ++v)
            for (uint32_t s = samples.start[v]; s < samples.start[v + 1] && !onEmitter(scene.mesh.positions[v]); ++s) {
                const Vec2 pixel =
                    *capture.views[samples.samples[s].view].camera.project(DVec3(scene.mesh.positions[v]));
                float nearest = 1e9f;
                for (uint32_t u : emitter.vertices)
                    if (const auto p =
                            capture.views[samples.samples[s].view].camera.project(DVec3(scene.mesh.positions[u])))
                        nearest = std::min(nearest, glm::length(*p - pixel));
                if (beside ? nearest > 4 : nearest < 30) continue;
                samples.samples[s].radiance = emitter.radiance;
                if (patch.vertices.empty() || patch.vertices.back() != v) patch.vertices.push_back(v);
            }
        return patch;
    };
    const EmitterCluster past = patchOf(true);
    ASSERT_GT(past.vertices.size(), 2u);
    EXPECT_TRUE(showsEmitterPastEdge(scene, capture, samples, emitter, past));
    EmitterCluster other = past;
    other.radiance = Rgb(9, 9, 4);
    EXPECT_FALSE(showsEmitterPastEdge(scene, capture, samples, emitter, other));
    const EmitterCluster apart = patchOf(false);
    ASSERT_GT(apart.vertices.size(), 2u);
    EXPECT_FALSE(showsEmitterPastEdge(scene, capture, samples, emitter, apart));
}

}  // namespace
}  // namespace relamp
