// Skirts before black: what a light would light and nothing shows.
#include "transport/unlit_skirts.h"

#include <gtest/gtest.h>

#include "support/estimates.h"
#include "transport/near_field.h"

namespace relamp {
namespace {

/// A table of two metres whose mesh is wider, under a panel; six views show it, and `sky` beside it.
struct LitTable {
    Scene scene;
    RadianceSamples samples;
    EmitterClusters clusters;
    static constexpr float wide = 1.3f, half = 1;

    explicit LitTable(float sky = 0) {
        Mesh mesh = test::sheet({-wide, -wide, 0}, {2 * wide, 0, 0}, {0, 2 * wide, 0}, 80, 80);
        const std::vector<uint32_t> panel = test::append(mesh, test::squareAbove(0.3f, 0, 0, 0.8f, 3));
        scene = test::sceneOf(mesh);
        clusters = test::emittersOf(scene, {panel}, {Rgb(20)});
        clusters.emitters[0].radiance = Rgb(20);
        samples.background.assign(size_t(samples.backgroundGrid.cells()), Rgb(sky));
        samples.backgroundPixels.assign(samples.background.size(), 9);
        samples.start.push_back(0);
        Progress progress;
        const NearField field = computeNearField(scene, clusters, {}, progress);
        for (uint32_t v = 0; v < scene.mesh.vertexCount(); ++v) {
            const Vec3 p = scene.mesh.positions[v];
            const bool table = p.z < 0.1f && std::max(std::abs(p.x), std::abs(p.y)) < half;
            const Rgb shown(p.z > 0.1f ? 20 : table ? 0.5f * field.at(v, 0) * 20 : sky);
            for (uint32_t view = 0; view < 6; ++view) samples.samples.push_back({view, shown, 1, false});
            samples.start.push_back(uint32_t(samples.samples.size()));
        }
    }
    std::vector<uint32_t> skirts() const {
        Progress progress;
        const std::vector<uint8_t> none(scene.mesh.vertexCount(), 0);
        return unlitSkirts(scene, samples, clusters, none, progress);
    }
    float farthest(uint32_t t) const {
        const Triangle& at = scene.mesh.triangles[t];
        const Vec3 p = (scene.mesh.positions[at[0]] + scene.mesh.positions[at[1]] + scene.mesh.positions[at[2]]) / 3.0f;
        return std::max(std::abs(p.x), std::abs(p.y));
    }
};

TEST(UnlitSkirts, GoWhereTheLightShowsNothing) {
    const LitTable table;
    const std::vector<uint32_t> found = table.skirts();
    for (const uint32_t t : found) EXPECT_GT(table.farthest(t), LitTable::half - 0.01f);
    size_t beyond = 0;
    for (uint32_t t = 0; t < table.scene.mesh.triangles.size(); ++t)
        beyond += table.farthest(t) > LitTable::half + 0.05f;
    EXPECT_GT(found.size(), beyond * 9 / 10);
    EXPECT_TRUE(std::is_sorted(found.begin(), found.end()));
}

TEST(UnlitSkirts, ADarkTableAndABrightSkyHaveNone) {
    EXPECT_TRUE(LitTable(0.05f).skirts().empty()) << "the background is not black";
    LitTable dark;
    for (RadianceSample& s : dark.samples.samples) s.radiance = glm::max(s.radiance, Rgb(0.02f));
    EXPECT_TRUE(dark.skirts().empty()) << "its border is a dark surface";
}

TEST(UnlitSkirts, ABlackPatchAwayFromTheRimStays) {
    LitTable table;
    for (uint32_t v = 0; v < table.scene.mesh.vertexCount(); ++v) {
        const Vec3 p = table.scene.mesh.positions[v];
        const bool patch = p.z < 0.1f && glm::length(Vec2(p) - Vec2(0.5f, 0)) < 0.3f;
        for (uint32_t k = table.samples.start[v]; k < table.samples.start[v + 1]; ++k)
            table.samples.samples[k].radiance = patch ? Rgb(0) : glm::max(table.samples.samples[k].radiance, Rgb(0.1f));
    }
    EXPECT_TRUE(table.skirts().empty());
}

TEST(UnlitSkirts, ALightThatFadesLeavesSurfacesDark) {
    LitTable table;
    for (uint32_t v = 0; v < table.scene.mesh.vertexCount(); ++v) {
        const float from = glm::length(Vec2(table.scene.mesh.positions[v]));
        for (uint32_t k = table.samples.start[v]; k < table.samples.start[v + 1]; ++k)
            table.samples.samples[k].radiance *= std::clamp((0.9f - from) / 0.5f, 0.0f, 1.0f);
    }
    EXPECT_TRUE(table.skirts().empty());
}

TEST(UnlitSkirts, WithoutALightOrInSeveralStatesNothingIsSaid) {
    LitTable table;
    table.samples.states = 2;
    EXPECT_TRUE(table.skirts().empty());
    table.samples.states = 1;
    table.clusters.emitters.clear();
    EXPECT_TRUE(table.skirts().empty());
}

}  // namespace
}  // namespace relamp
