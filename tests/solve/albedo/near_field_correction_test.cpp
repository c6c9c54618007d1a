#include "solve/albedo/near_field_correction.h"

#include <gtest/gtest.h>

#include "support/shapes.h"

namespace relamp {
namespace {

constexpr float half = 0.15f;  // of the panel's side

/// A papered wall with a panel of light in front of it.
struct Wall {
    Scene scene;
    MatteObservations matte;
    Irradiance known;         ///< with the form factors of the mesh
    std::vector<Rgb> actual;  ///< irradiance as photographed
    NearField nearField;
    EmitterClusters emitters;
    std::vector<Rgb> radiance{Rgb(5, 4, 3)};

    static Mesh mesh() {
        Mesh m = test::sheet({-0.6f, -0.6f, 0}, {1.2f, 0, 0}, {0, 1.2f, 0}, 60, 60);
        test::append(m, test::sheet({-half, -half, 0.02f}, {2 * half, 0, 0}, {0, 2 * half, 0}, 15, 15));
        return m;
    }
    static float distance(const Vec3& p) { return std::max({std::abs(p.x) - half, std::abs(p.y) - half, 0.0f}); }
    static Rgb albedoAt(const Vec3& p) {
        return int(std::floor((p.x + 10) / 0.08f)) % 2 ? Rgb(0.6f, 0.5f, 0.4f) : Rgb(0.3f, 0.35f, 0.4f);
    }

    /// Form factor of a strip that stands up from the wall.
    static float strip(float height, float d) { return 0.5f - 0.5f / std::sqrt(1 + height * height / (d * d)); }

    /// `missing`: form factor that the mesh lacks beside the panel. `higher`: so much the panel is farther from the
    /// wall than in the mesh.
    explicit Wall(float missing, float higher = 0) : scene(test::sceneOf(mesh())) {
        const size_t wall = 61 * 61;
        EmitterCluster panel;
        for (uint32_t t = 0; t < scene.mesh.triangles.size(); ++t)
            if (scene.mesh.triangles[t][0] >= wall) panel.triangles.push_back(t);
        panel.centroid = Vec3(0, 0, 0.02f);
        panel.area = 4 * half * half;
        emitters.emitters.push_back(panel);
        nearField.emitters = 1;
        nearField.formFactor.assign(scene.mesh.vertexCount(), 0);
        for (uint32_t v = 0; v < wall; ++v) {
            const Vec3& p = scene.mesh.positions[v];
            const float d = distance(p);
            if (d <= 0.01f) continue;  // behind the panel
            nearField.formFactor[v] = 0.02f * std::exp(-d / 0.05f);
            const Rgb light = Rgb(0.3f) + nearField.formFactor[v] * radiance[0];
            matte.vertices.push_back(v);
            known.value.push_back(light);
            known.sigma.push_back(0.01f * light);
            const float rises = strip(0.02f + higher, d) - strip(0.02f, d);
            actual.push_back(light + (missing * std::exp(-d / 0.04f) + rises) * radiance[0]);
            matte.radiance.push_back(albedoAt(p) * actual.back());
            matte.sigma.push_back(0.01f * matte.radiance.back());
        }
    }

    NearFieldCorrection correct(float meshError) const {
        Progress progress;
        return correctNearField({scene, matte, known, nearField, emitters, radiance, meshError}, progress);
    }
    /// Root mean square relative error of the light at such distances from the panel.
    double error(const Irradiance& light, float from = 0, float to = 0.1f) const {
        double sum = 0, count = 0;
        for (size_t i = 0; i < matte.vertices.size(); ++i) {
            const float d = distance(scene.mesh.positions[matte.vertices[i]]);
            if (d < from || d > to) continue;
            sum += std::pow(double(light.value[i].x / actual[i].x - 1), 2);
            ++count;
        }
        return std::sqrt(sum / count);
    }
};

TEST(NearFieldCorrection, FindsTheLightFromAGapThatTheMeshDoesNotHave) {
    const Wall wall(0.12f);
    const NearFieldCorrection found = wall.correct(0.012f);
    ASSERT_FALSE(found.empty());
    Irradiance corrected = wall.known;
    addCorrection(found, wall.matte, wall.radiance, {}, corrected);
    EXPECT_GT(wall.error(wall.known), 0.3);
    EXPECT_LT(wall.error(corrected), 0.3 * wall.error(wall.known));
    for (size_t v = 0; v < found.emitter.size(); ++v)
        if (Wall::distance(wall.scene.mesh.positions[v]) > 0.4f) { EXPECT_NEAR(found.formFactor[v], 0, 2e-3) << v; }
}

TEST(NearFieldCorrection, FollowsLightAlongAWallFartherThanLightFromAbove) {
    const Wall wall(0, 0.01f);
    const NearFieldCorrection found = wall.correct(0.005f);  // 15 times that: 7.5 cm
    ASSERT_FALSE(found.empty());
    Irradiance corrected = wall.known;
    addCorrection(found, wall.matte, wall.radiance, {}, corrected);
    EXPECT_GT(wall.error(wall.known, 0.08f, 0.15f), 0.05);
    EXPECT_LT(wall.error(corrected, 0.08f, 0.15f), 0.75 * wall.error(wall.known, 0.08f, 0.15f));
    EXPECT_LT(wall.error(corrected, 0, 0.08f), 0.5 * wall.error(wall.known, 0, 0.08f));
}

TEST(NearFieldCorrection, LeavesLightThatIsRightAlone) {
    const Wall wall(0);
    EXPECT_TRUE(wall.correct(0.012f).empty());  // stripes are no reason
}

TEST(NearFieldCorrection, IsLeftOutOnAnExactMeshAndWithoutEmitters) {
    Wall wall(0.12f);
    EXPECT_TRUE(wall.correct(0).empty());
    wall.emitters.emitters.clear();
    EXPECT_TRUE(wall.correct(0.012f).empty());
}

}  // namespace
}  // namespace relamp
