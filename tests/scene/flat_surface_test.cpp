#include "scene/flat_surface.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/progress.h"

namespace relamp {
namespace {

/// A floor of 2 x 2 m with waves of `height` metres and a wall of 1 m at its end; a step 30 mm high stands on it.
Mesh wavyCorner(float height) {
    Mesh mesh;
    constexpr uint32_t n = 60;
    const auto sheet = [&](const auto& point) {
        const auto first = uint32_t(mesh.positions.size());
        for (uint32_t i = 0; i <= n; ++i)
            for (uint32_t j = 0; j <= n; ++j) mesh.positions.push_back(point(float(i) / n, float(j) / n));
        for (uint32_t i = 0; i < n; ++i)
            for (uint32_t j = 0; j < n; ++j) {
                const uint32_t a = first + i * (n + 1) + j, b = a + n + 1;
                mesh.triangles.push_back({a, b, b + 1});
                mesh.triangles.push_back({a, b + 1, a + 1});
            }
    };
    sheet([&](float s, float t) {
        const float wave = height * std::sin(15 * s) * std::cos(11 * t);
        const bool step = s > 0.4f && s < 0.6f && t > 0.4f && t < 0.6f;
        return Vec3(2 * s, 2 * t, step ? 0.03f : wave);
    });
    sheet([&](float s, float t) { return Vec3(2 * s, 2 + height * std::sin(17 * s + 9 * t), t); });
    mesh.normals = vertexNormalsFromFaces(mesh);
    return mesh;
}

TEST(Flattening, BringsWavesOntoTheirPlanesAndKeepsWhatStandsOut) {
    Progress progress;
    constexpr float height = 0.004f;
    const Scene scene = buildScene(wavyCorner(height), progress);
    std::vector<uint8_t> lights(scene.mesh.vertexCount(), 0);
    lights[0] = 1;
    const std::vector<FlatSurface> surfaces = flatSurfaces(scene, lights);
    ASSERT_EQ(surfaces.size(), 2);
    const Flattening flat = flattening(scene, surfaces, scene.mesh.vertexCount(), lights);
    ASSERT_EQ(flat.waves.size(), 2);
    for (const double waves : flat.waves) {
        EXPECT_GT(waves, 0.2 * double(height));
        EXPECT_LT(waves, 1.2 * double(height));
    }
    EXPECT_EQ(flat.move[0], 0);
    size_t onto = 0, standing = 0;
    for (uint32_t v = 1; v < scene.mesh.vertexCount(); ++v) {
        const Vec3 before = scene.mesh.positions[v], after = before + flat.move[v] * scene.mesh.normals[v];
        if (before.z == 0.03f) {
            EXPECT_EQ(flat.surface[v], -1);
            EXPECT_NEAR(after.z, 0.03f, 0.75f * height);
            ++standing;
        }
        if (flat.surface[v] < 0) continue;
        EXPECT_LT(std::abs(surfaces[size_t(flat.surface[v])].off(DVec3(after))), 1e-6);
        ++onto;
    }
    EXPECT_GT(standing, 100);
    EXPECT_GT(onto, 0.85 * double(scene.mesh.vertexCount()));
}

TEST(Flattening, LeavesSidesOfRoundThings) {
    Progress progress;
    Mesh drum;
    constexpr uint32_t around = 90, up = 40;
    for (uint32_t i = 0; i <= around; ++i)
        for (uint32_t j = 0; j <= up; ++j) {
            const float a = 2 * pi * float(i) / around;
            drum.positions.push_back({std::cos(a), std::sin(a), 2 * float(j) / up});
        }
    for (uint32_t i = 0; i < around; ++i)
        for (uint32_t j = 0; j < up; ++j) {
            const uint32_t a = i * (up + 1) + j, b = a + up + 1;
            drum.triangles.push_back({a, b, b + 1});
            drum.triangles.push_back({a, b + 1, a + 1});
        }
    drum.normals = vertexNormalsFromFaces(drum);
    const Scene scene = buildScene(std::move(drum), progress);
    const std::vector<uint8_t> lights(scene.mesh.vertexCount(), 0);
    const std::vector<FlatSurface> surfaces = flatSurfaces(scene, lights);
    ASSERT_FALSE(surfaces.empty());
    const Flattening flat = flattening(scene, surfaces, scene.mesh.vertexCount(), lights);
    for (size_t s = 0; s < surfaces.size(); ++s) EXPECT_FALSE(flat.isFlat(s)) << flat.bent[s];
    for (const float m : flat.move) EXPECT_EQ(m, 0);
}

TEST(Flattening, MovesOnlyTheFirstVertices) {
    Progress progress;
    const Scene scene = buildScene(wavyCorner(0.004f), progress);
    const std::vector<uint8_t> lights(scene.mesh.vertexCount(), 0);
    const Flattening flat = flattening(scene, flatSurfaces(scene, lights), 100, lights);
    EXPECT_EQ(flat.move.size(), 100);
    EXPECT_EQ(flat.surface.size(), 100);
}

}  // namespace
}  // namespace relamp
