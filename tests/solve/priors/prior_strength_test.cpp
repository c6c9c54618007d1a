#include "solve/priors/prior_strength.h"

#include <gtest/gtest.h>

#include "support/shapes.h"
#include "tests/solve/small_problem.h"

namespace relamp {
namespace {

TEST(PriorStrength, IsTheUsualOneUnlessAnotherIsClearlyBetter) {
    EXPECT_EQ(chooseStrength({{9, 8, 9, 7}, {10, 10, 10, 10}, {11, 12, 11, 10}}).factor, 0.25f);
    EXPECT_EQ(chooseStrength({{9, 12, 9, 9.5}, {10, 10, 10, 10}, {11, 12, 11, 10}}).factor,
              1);  // better by less than its error
    EXPECT_EQ(chooseStrength({{10, 10, 10, 10}, {10, 10, 10, 10}, {9, 8.9, 9.1, 9}}).chosenBy, "photographs");
    EXPECT_EQ(chooseStrength({{1}, {10}, {100}}).factor, 1);  // one block tells no error
    EXPECT_EQ(chooseStrength({{0, 0}, {0, 0}, {0, 0}}).factor, 1);
}

/// A matte sheet under even light, seen by three noisy views.
struct NoisySheet {
    Scene scene = test::sceneOf(test::sheet({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, 40, 40));
    RadianceSamples samples;
    MatteObservations matte;
    std::vector<Rgb> lit, litSigma, albedo;

    NoisySheet(float texture, float noise) {
        std::mt19937 random(3);
        std::normal_distribution<float> normal(0, 1);
        samples.relativeNoise = noise;
        for (uint32_t v = 0; v < scene.mesh.vertexCount(); ++v) {
            const Rgb a(0.5f * std::exp(texture * normal(random)));
            samples.start.push_back(uint32_t(samples.samples.size()));
            for (uint32_t view = 0; view < 3; ++view)
                samples.samples.push_back({view, a * std::exp(noise * normal(random)), 1, false});
            lit.push_back(Rgb(1));
            litSigma.push_back(Rgb(0));
        }
        samples.start.push_back(uint32_t(samples.samples.size()));
        matte = matteObservations(scene, samples, std::vector<uint8_t>(scene.mesh.vertexCount(), 0));
        matte.componentGlossy.assign(scene.components, 0);
        Progress progress;
        albedo = solveAlbedo(scene, matte, lit, litSigma, {}, progress).albedo;
    }
    PriorStrength ask() const {
        Progress progress;
        return testAlbedoStrength(scene, samples, matte, lit, litSigma, {}, albedo, 1, progress);
    }
};

TEST(PriorStrength, OfSurfacesFollowsTheirTexture) {
    EXPECT_EQ(NoisySheet(0, 0.1f).ask().factor, 4);
    EXPECT_EQ(NoisySheet(0.4f, 0.05f).ask().factor, 0.25f);
    const PriorStrength told = NoisySheet(0, 0.1f).ask();
    ASSERT_EQ(told.trials.size(), strengthsTried().size());
    EXPECT_EQ(told.trials[1].misfit, 1);
    EXPECT_LT(told.trials[2].misfit, 1);
}

TEST(PriorStrength, OfLightTellsRoughLightFromSmooth) {
    // Light that changes wildly from leaf to leaf, hardly any noise: a strong prior predicts the pairs left out worse.
    test::SmallProblem p = test::smallProblem(3000, 0.002f);
    for (size_t i = 0; i < p.truth.leafRadiance.size(); ++i)
        p.truth.leafRadiance[i] = Rgb(i * 7 % 5 == 0 ? 6.0f : 0.2f);
    std::vector<Vec3> positions;
    for (size_t r = 0; r < p.influence.rows; ++r) {
        p.matte.radiance[r] = p.albedo[r] * lightOfRow(p.influence.row(r), p.truth);
        p.matte.sigma[r] = 0.002f * p.matte.radiance[r];
        positions.push_back(Vec3(float(r / 10 % 20), float(r / 200), 0));
    }
    Progress progress;
    AlbedoFreeOptions options;
    options.mismatch = 0.002f;
    options.light.smoothness *= 1000;
    Lighting found = p.truth;
    const PriorStrength strength =
        testLightStrength(p.influence, p.matte, p.pairs, positions, p.anchors, options, found, 3000, progress);
    ASSERT_EQ(strength.trials.size(), 3u);
    EXPECT_LT(strength.trials[0].misfit, 1);
    EXPECT_GT(strength.trials[2].misfit, 1);
    EXPECT_EQ(strength.factor, 0.25f);
    // Too little to ask.
    p.pairs.resize(50);
    EXPECT_TRUE(testLightStrength(p.influence, p.matte, p.pairs, positions, p.anchors, options, found, 3000, progress)
                    .trials.empty());
}

}  // namespace
}  // namespace relamp
