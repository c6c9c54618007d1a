#include "solve/albedo/palette.h"

#include <gtest/gtest.h>

#include <random>

#include "support/shapes.h"

namespace relamp {
namespace {

TEST(Palette, FindsThePaintsThatPointsGatherAbout) {
    std::mt19937 random(7);
    std::normal_distribution<float> normal(0, 0.03f);
    const Rgb paints[3] = {Rgb(0.6f, 0.5f, 0.4f), Rgb(0.1f, 0.3f, 0.6f), Rgb(0.8f, 0.05f, 0.05f)};
    std::vector<Rgb> albedo;
    std::vector<float> weight;
    for (int i = 0; i < 3000; ++i) {
        const int paint = i % 10 < 6 ? 0 : i % 10 < 9 ? 1 : 2;
        albedo.push_back(paints[paint] * glm::exp(Rgb(normal(random), normal(random), normal(random))));
        weight.push_back(1);
    }
    for (int i = 0; i < 30; ++i) {  // strange points become no material
        albedo.push_back(glm::exp(Rgb(float(i % 7), float(i % 5), float(i % 3)) * -1.0f));
        weight.push_back(i % 2 ? 1.0f : 0.0f);
    }
    for (const size_t count : {3u, 6u}) {
        const Palette palette = findPalette(albedo, weight, count);
        ASSERT_GE(palette.colours.size(), 3u);
        for (int k = 0; k < 3; ++k)
            for (int c = 0; c < 3; ++c)
                EXPECT_NEAR(palette.colours[size_t(k)].albedo[c] / paints[k][c], 1, 0.02f) << k << " of " << count;
        EXPECT_NEAR(palette.colours[0].fraction, 0.6f, 0.02f);
        EXPECT_NEAR(palette.colours[2].fraction, 0.1f, 0.02f);
        EXPECT_EQ(palette.nearest[9], palette.colours[2].albedo);
    }
    EXPECT_TRUE(findPalette(albedo, std::vector<float>(albedo.size(), 0.0f), 3).colours.empty());
}

TEST(Palette, MakesPaintedSurfacesEvenAndLeavesOtherColoursAlone) {
    const Scene scene = test::sceneOf(test::sheet({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, 30, 30));
    std::mt19937 random(9);
    std::normal_distribution<float> normal(0, 1);
    MatteObservations matte;
    std::vector<Rgb> lit, litSigma, truth;
    for (uint32_t v = 0; v < scene.mesh.vertexCount(); ++v) {
        const Vec3 p = scene.mesh.positions[v];
        truth.push_back(p.x < 0.5f ? Rgb(0.7f, 0.6f, 0.5f) : Rgb(0.2f, 0.4f, 0.3f));
        if (glm::distance(p, Vec3(0.2f, 0.2f, 0)) < 0.08f)
            truth.back() = Rgb(0.05f, 0.05f, 0.4f);  // a spot that is no paint of two
        matte.vertices.push_back(v);
        matte.radiance.push_back(truth[v] * std::exp(0.1f * normal(random)));
        matte.sigma.push_back(0.1f * truth[v]);
        lit.push_back(Rgb(1));
        litSigma.push_back(Rgb(0));
    }
    Progress progress;
    const AlbedoResult plain = solveAlbedo(scene, matte, lit, litSigma, {}, progress);
    Palette palette;
    const AlbedoResult painted = solveAlbedoWithPalette(scene, matte, lit, litSigma, {}, 2, plain, palette, progress);
    const auto error = [&](const AlbedoResult& r) {
        double sum = 0;
        for (size_t v = 0; v < truth.size(); ++v)
            if (truth[v].x > 0.1f) sum += std::pow(std::log(double(r.albedo[v].y / truth[v].y)), 2);
        return std::sqrt(sum);
    };
    EXPECT_LT(error(painted), 0.75 * error(plain));
    for (uint32_t v = 0; v < scene.mesh.vertexCount(); ++v) {
        if (glm::distance(scene.mesh.positions[v], Vec3(0.2f, 0.2f, 0)) >= 0.04f) continue;
        EXPECT_NEAR(painted.albedo[v].x, 0.05f, 0.02f);
    }
}

}  // namespace
}  // namespace relamp
