#include "solve/albedo/shadow_edges.h"

#include <gtest/gtest.h>

#include "solve/albedo/albedo_step.h"
#include "support/shapes.h"

namespace relamp {
namespace {

constexpr uint32_t side = 20;

/// A square of side x side vertices; columns from `fold` on stand upright.
Scene foldedScene(uint32_t fold) {
    Mesh mesh;
    for (uint32_t y = 0; y < side; ++y)
        for (uint32_t x = 0; x < side; ++x) {
            const float along = 0.1f * float(std::min(x, fold)), up = 0.1f * float(x - std::min(x, fold));
            mesh.positions.push_back(Vec3(along, 0.1f * float(y), up));
            mesh.normals.push_back(x < fold ? Vec3(0, 0, 1) : Vec3(-1, 0, 0));
        }
    for (uint32_t y = 0; y + 1 < side; ++y)
        for (uint32_t x = 0; x + 1 < side; ++x) {
            const uint32_t v = y * side + x;
            mesh.triangles.push_back({v, v + 1, v + side});
            mesh.triangles.push_back({v + 1, v + side + 1, v + side});
        }
    // Far away, so that the square's edges are a small part of the scene.
    for (const Vec3& p : {Vec3(30, 30, 0), Vec3(31, 30, 0), Vec3(30, 31, 0)}) {
        mesh.positions.push_back(p);
        mesh.normals.push_back({0, 0, 1});
    }
    mesh.triangles.push_back({side * side, side * side + 1, side * side + 2});
    Progress progress;
    return buildScene(mesh, progress);
}

/// Every vertex seen with `radiance(x)` where the mesh says `light(x)`, x the column.
struct Shadowed {
    MatteObservations matte;
    Irradiance irradiance;
    template <typename Radiance, typename Light>
    Shadowed(const Scene& scene, Radiance radiance, Light light) {
        matte.componentGlossy.assign(scene.components, 0);
        matte.viewSpread.assign(scene.components, 0);
        for (uint32_t v = 0; v < side * side; ++v) {
            const float y = radiance(v % side), l = light(v % side);
            matte.vertices.push_back(v);
            matte.radiance.push_back(Rgb(y));
            matte.sigma.push_back(Rgb(0.01f * y + 1e-5f));
            irradiance.value.push_back(Rgb(l));
            irradiance.sigma.push_back(Rgb(0.01f * l));
        }
    }
};

TEST(ShadowEdges, OfAMisplacedShadowDarkenNoAlbedo) {
    const Scene scene = foldedScene(side);
    // The mesh's shadow begins one column later than the photographs'.
    const Shadowed s(
        scene, [](uint32_t x) { return x < 10 ? 0.5f : 0.0f; }, [](uint32_t x) { return x < 11 ? 1.0f : 0.0f; });
    const Irradiance unsure = unsureAtShadows(scene, s.matte, s.irradiance);
    Progress progress;
    const AlbedoResult sure = solveAlbedo(scene, s.matte, s.irradiance.value, s.irradiance.sigma, {}, progress),
                       result = solveAlbedo(scene, s.matte, unsure.value, unsure.sigma, {}, progress);
    EXPECT_LT(sure.albedo[10 * side + 10].x, 0.05f) << "the shadow becomes paint, and so does all within it";
    EXPECT_LT(sure.albedo[10 * side + 15].x, 0.05f);
    EXPECT_GT(result.albedo[10 * side + 10].x, 0.4f);
    EXPECT_NEAR(result.albedo[10 * side + 15].x, 0.5f, 0.1f);
    EXPECT_NEAR(result.albedo[10 * side + 5].x, 0.5f, 0.01f);
}

TEST(ShadowEdges, AreNeitherEvenLightNorTheTurnOfTheSurface) {
    const Scene scene = foldedScene(10);
    const Shadowed s(
        scene, [](uint32_t x) { return x < 10 ? 0.5f : 0.1f; }, [](uint32_t x) { return x < 10 ? 1.0f : 0.2f; });
    const Irradiance unsure = unsureAtShadows(scene, s.matte, s.irradiance);
    for (size_t i = 0; i < side * side; ++i) {
        EXPECT_EQ(unsure.value[i], s.irradiance.value[i]);
        EXPECT_LT(unsure.sigma[i].x, 0.016f);
    }
}

TEST(ShadowEdges, AreNotWhereLightFadesSmoothly) {
    const Scene scene = foldedScene(side);
    const auto light = [](uint32_t x) { return 0.1f + 0.02f * float((int(x) - 10) * (int(x) - 10)); };
    const Shadowed s(
        scene, [&](uint32_t x) { return 0.5f * light(x); }, light);
    const Irradiance unsure = unsureAtShadows(scene, s.matte, s.irradiance);
    const float floor = 0.01f * 0.6f;
    for (uint32_t x = 4; x < 16; ++x)
        EXPECT_LT(unsure.sigma[10 * side + x].x, 0.02f * light(x) + floor) << "column " << x;
}

TEST(ShadowEdges, OfNothingObservedAreNone) {
    const Scene scene = foldedScene(side);
    EXPECT_TRUE(unsureAtShadows(scene, {}, {}).value.empty());
}

TEST(AlbedoPrior, EndsAtCreases) {
    // Red stands on grey; half of each is in the dark next to the crease.
    const Scene scene = foldedScene(10);
    const Shadowed lit(
        scene, [](uint32_t x) { return x < 10 ? 0.5f : 0.1f; },
        [](uint32_t x) { return x < 6 || x > 13 ? 1.0f : 0.0f; });
    Progress progress;
    const AlbedoResult result = solveAlbedo(scene, lit.matte, lit.irradiance.value, lit.irradiance.sigma, {}, progress);
    EXPECT_NEAR(result.albedo[10 * side + 8].x, 0.5f, 0.07f);
    EXPECT_NEAR(result.albedo[10 * side + 11].x, 0.1f, 0.03f);
}

}  // namespace
}  // namespace relamp
