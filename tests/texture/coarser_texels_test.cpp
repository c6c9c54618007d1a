#include "texture/coarser_texels.h"

#include <gtest/gtest.h>

#include "base/parallel.h"
#include "base/random.h"
#include "support/shapes.h"
#include "texture/atlas.h"

namespace relamp {
namespace {

/// Two charts of one square each, side by side with a gap; the left one is a board of light and dark texels, the
/// right one red. Two texels beside them are as they are; beyond lies something that no chart has.
AlbedoTexture board() {
    AlbedoTexture texture{128, 64, {}, std::vector<Rgb>(128 * 64, Rgb(0, 0, 1))};
    for (int y = 0; y < 64; ++y)
        for (int x = 0; x < 128; ++x) {
            Rgb& texel = texture.texels[size_t(y * 128 + x)];
            if (x >= 2 && x < 62 && y >= 2 && y < 62) texel = Rgb((x + y) % 2 ? 0.8f : 0.2f);
            if (x >= 66 && x < 126 && y >= 2 && y < 62) texel = Rgb(0.6f, 0, 0);
        }
    texture.corners = {{Vec2(4, 4), Vec2(60, 4), Vec2(60, 60)},
                       {Vec2(4, 4), Vec2(60, 60), Vec2(4, 60)},
                       {Vec2(68, 4), Vec2(124, 4), Vec2(124, 60)},
                       {Vec2(-1), Vec2(-1), Vec2(-1)}};
    addCoarser(texture);
    return texture;
}

TEST(CoarserTexels, UpToATexelItIsTheTextureItself) {
    const AlbedoTexture texture = board();
    for (uint32_t i = 0; i < 200; ++i) {
        const Vec2 place = Vec2(6) + 50.0f * r2Point(i, Vec2(0));
        EXPECT_EQ(texture.over(0, place, {0.9f, 0}, {0, 0.4f}), texture.at(place));
    }
}

TEST(CoarserTexels, AWideFootprintIsTheMean) {
    const AlbedoTexture texture = board();
    for (uint32_t i = 0; i < 200; ++i) {
        const Vec2 place = Vec2(16) + 30.0f * r2Point(i, Vec2(0));
        for (const float side : {4.0f, 8.0f, 20.0f, 500.0f}) {
            const Rgb seen = texture.over(0, place, {side, 0}, {0, side});
            EXPECT_LT(glm::length(seen - Rgb(0.5f)), 0.02f) << side;
        }
        // Seen at a slant: one side is short, the other long.
        EXPECT_LT(glm::length(texture.over(0, place, {0, 12}, {1, 0}) - Rgb(0.5f)), 0.05f);
    }
}

/// Cells of the coarsest copies are wider than the gap, so a little of the other chart comes in at the rim.
TEST(CoarserTexels, AChartShowsNothingOfTheGapAndHardlyAnyOfAnother) {
    const AlbedoTexture texture = board();
    for (uint32_t i = 0; i < 400; ++i) {
        const Vec2 place = Vec2(68, 4) + 56.0f * r2Point(i, Vec2(0));
        if (place.y - 4 > place.x - 68) continue;
        for (const float side : {2.0f, 4.0f, 16.0f, 200.0f}) {
            const Rgb seen = texture.over(2, place, {side, 0}, {0, side / 3});
            EXPECT_LT(glm::length(seen - Rgb(0.6f, 0, 0)), side > 8 ? 0.02f : 1e-4f)
                << place.x << " " << place.y << " " << side;
        }
    }
}

/// A ball in many charts, printed as fine as its texels.
TEST(CoarserTexels, KeepTheMeanOfTheSurface) {
    const Mesh mesh = test::ball({0, 0, 0}, 1, 24, 48);
    Progress progress;
    const Atlas atlas = layOut(mesh, std::vector<float>(mesh.triangles.size(), 120), {}, progress);
    ASSERT_GT(atlas.charts, 4u);
    AlbedoTexture texture{atlas.width, atlas.height, atlas.corners, {}, {}, {}, {}};
    texture.texels.assign(size_t(atlas.width) * size_t(atlas.height), Rgb(0));
    // Each chart has a level of its own, so that what comes in from another chart would be noticed.
    for (uint32_t t = 0; t < mesh.triangles.size(); ++t) {
        const float level = 0.2f + 0.6f * float(mixBits(atlas.chartOf[t]) % 1024) / 1024;
        const std::array<Vec2, 3>& c = texture.corners[t];
        const Vec2 low = glm::min(c[0], glm::min(c[1], c[2])) - 2.0f,
                   high = glm::max(c[0], glm::max(c[1], c[2])) + 2.0f;
        for (int y = int(low.y); y < int(high.y); ++y)
            for (int x = int(low.x); x < int(high.x); ++x)
                texture.texels[size_t(y) * size_t(atlas.width) + size_t(x)] =
                    level * Rgb((x + y) % 2 ? 1.0f : 0.2f, (x / 2) % 2 ? 0.9f : 0.3f, 0.5f);
    }
    addCoarser(texture);
    for (const float side : {1.5f, 2.0f, 3.0f, 6.0f, 12.0f, 24.0f, 100.0f}) {
        Rgb fine(0), coarse(0);
        for (uint32_t t = 0; t < mesh.triangles.size(); ++t)
            for (uint32_t i = 0; i < 100; ++i) {
                const Vec2 r = r2Point(i, Vec2(0)), b = r.x + r.y <= 1 ? r : Vec2(1 - r.x, 1 - r.y);
                const Vec2 place = texture.place(t, b);
                fine += mesh.triangleArea(t) * texture.at(place);
                coarse += mesh.triangleArea(t) * texture.over(t, place, {side, 0}, {0, side});
            }
        for (int c = 0; c < 3; ++c) EXPECT_NEAR(coarse[c] / fine[c], 1, 0.01f) << side;
    }
}

TEST(CoarserTexels, SliversAndTinyImagesHaveAMeanToo) {
    AlbedoTexture texture{2, 2, {{Vec2(0.6f), Vec2(0.7f, 0.6f), Vec2(0.7f, 0.7f)}}, std::vector<Rgb>(4, Rgb(0.3f))};
    addCoarser(texture);
    EXPECT_TRUE(texture.coarser.empty());
    EXPECT_LT(glm::length(texture.ofTriangle[0] - Rgb(0.3f)), 1e-6f);
    EXPECT_LT(glm::length(texture.over(0, {0.65f, 0.65f}, {90, 0}, {0, 90}) - Rgb(0.3f)), 1e-6f);
}

TEST(CoarserTexels, SameBitsOnAnyNumberOfThreads) {
    AlbedoTexture one;
    {
        const ThreadLimit limit(1);
        one = board();
    }
    const ThreadLimit limit(3);
    const AlbedoTexture three = board();
    ASSERT_EQ(one.coarser.size(), 4u);
    for (size_t k = 0; k < one.coarser.size(); ++k) EXPECT_EQ(one.coarser[k].texels, three.coarser[k].texels);
}

}  // namespace
}  // namespace relamp
