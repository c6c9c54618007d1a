#include "solve/ratio/pair_precision.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <random>

#include "tests/solve/small_problem.h"

namespace relamp {
namespace {

TEST(PairPrecision, WithNothingSharedEachChannelHasItsOwnVariance) {
    const PairPrecision p = pairPrecision({Rgb(0.01f, 0.02f, 0.03f), Rgb(0.03f, 0.02f, 0.01f)}, {});
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(p(c, c), 25, 1e-3);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(p(c, (c + 1) % 3), 0, 1e-3);
}

TEST(PairPrecision, IsTheInverseOfTheCovariance) {
    const PairVariance v{Rgb(0.01f, 0.02f, 0.03f), Rgb(0.05f, 0.04f, 0.1f)};
    const ChromaFraction fraction{0.5f, 0.1f};
    Eigen::Matrix3d covariance, precision;
    const PairPrecision p = pairPrecision(v, fraction);
    double own[3];
    for (int c = 0; c < 3; ++c) own[c] = (0.5 * double(v.noise[c]) + 0.1 * double(v.model[c])) / 4;
    for (int c = 0; c < 3; ++c)
        for (int d = 0; d < 3; ++d) {
            const double common = std::sqrt((double(v.noise[c]) + v.model[c] - own[c]) / 3 *
                                            (double(v.noise[d]) + v.model[d] - own[d]) / 3);
            covariance(c, d) = (c == d ? own[c] : 0.0) + common;
            precision(c, d) = p(c, d);
        }
    EXPECT_LT((covariance * precision - Eigen::Matrix3d::Identity()).norm(), 1e-5);
    const double r[3] = {0.3, -0.1, 0.2};
    const Eigen::Map<const Eigen::Vector3d> v3(r);
    EXPECT_NEAR(p.square(r), v3.dot(precision * v3), 1e-6);
}

TEST(PairPrecision, ErrorsOfHueComeOnTop) {
    PairVariance v{Rgb(0.01f, 0.02f, 0.03f), Rgb(0.05f, 0.04f, 0.1f)};
    const ChromaFraction fraction{0.5f, 0.1f};
    const auto covariance = [&] {
        Eigen::Matrix3d m;
        const PairPrecision p = pairPrecision(v, fraction);
        for (int c = 0; c < 3; ++c)
            for (int d = 0; d < 3; ++d) m(c, d) = p(c, d);
        return Eigen::Matrix3d(m.inverse());
    };
    const Eigen::Matrix3d before = covariance();
    const Eigen::Vector3d share(0.2, -0.05, -0.15);
    v.hue = {0.04f, 0.0025f, 0.0225f, -0.01f, -0.03f, 0.0075f};
    EXPECT_LT((covariance() - before - share * share.transpose()).norm(), 1e-5);
    EXPECT_NEAR(pairPrecision(v, {})(0, 1), 0, 1e-6);
}

TEST(PairPrecision, BrightnessCountsTheSameWhateverIsShared) {
    const PairVariance v{Rgb(0.02f), Rgb(0.05f)};
    const double grey[3] = {0.1, 0.1, 0.1};
    EXPECT_NEAR(pairPrecision(v, {0.02f, 0.02f}).square(grey), pairPrecision(v, {}).square(grey), 1e-3);
}

TEST(ChromaFraction, IsMeasuredFromResiduals) {
    std::mt19937 random(3);
    std::normal_distribution<float> normal;
    std::vector<Rgb> residual;
    std::vector<PairVariance> variance;
    for (int i = 0; i < 20000; ++i) {
        // Noise from a hundredth of the texture to ten times it.
        const PairVariance v{Rgb(1e-4f * std::pow(1000.0f, float(i % 100) / 100)), Rgb(0.01f)};
        const float common = normal(random);
        Rgb r(0);
        for (int c = 0; c < 3; ++c)
            r[c] = std::sqrt(0.3f * v.noise[c] + 0.04f * v.model[c]) * normal(random) + 0.1f * common;
        residual.push_back(r);
        variance.push_back(v);
    }
    const ChromaFraction fraction = chromaFraction(residual, variance);
    EXPECT_NEAR(fraction.noise, 0.3f, 0.05f);
    EXPECT_NEAR(fraction.model, 0.04f, 0.015f);
}

TEST(ChromaFraction, DoesNotHoldWhatErrorsOfSingleLightsExplain) {
    std::mt19937 random(4);
    std::normal_distribution<float> normal;
    std::vector<Rgb> residual;
    std::vector<PairVariance> variance;
    for (int i = 0; i < 20000; ++i) {
        PairVariance v{Rgb(1e-5f), Rgb(0.01f)};
        const float mixed = i % 2 ? 0.05f : 0.0f;  // half of the pairs are where a red light meets others
        v.hue = {mixed * mixed,      mixed * mixed / 4,  mixed * mixed / 4,
                 -mixed * mixed / 2, -mixed * mixed / 2, mixed * mixed / 4};
        const float error = mixed * normal(random);
        Rgb r(error, -error / 2, -error / 2);
        for (int c = 0; c < 3; ++c) r[c] += std::sqrt(0.02f * v.model[c]) * normal(random);
        residual.push_back(r);
        variance.push_back(v);
    }
    EXPECT_NEAR(chromaFraction(residual, variance).model, 0.02f, 0.008f);
    for (PairVariance& v : variance) v.hue = {};
    EXPECT_GT(chromaFraction(residual, variance).model, 0.035f);
}

TEST(ChromaFraction, OfTooFewPairsIsOne) {
    EXPECT_TRUE(chromaFraction(std::vector<Rgb>(20, Rgb(0.1f)), std::vector<PairVariance>(20)).apart());
}

// Texture of 20 % leaves the light uncertain in each channel alone, and hardly in their ratios.
TEST(AlbedoFree, BrightAndDarkTextureHardlyDisturbsTheHueOfTheLight) {
    test::SmallProblem p = test::smallProblem(600);
    const size_t emitter = p.truth.leaves.size();
    const Rgb sky(0.6f, 0.8f, 1.0f);
    for (Rgb& l : p.truth.leafRadiance) l = sky;
    std::mt19937 random(7);
    std::normal_distribution<float> normal;
    for (size_t r = 0; r < p.matte.radiance.size(); ++r) {
        Rgb y = p.influence.row(r)[emitter] * p.truth.emitterRadiance[0];
        for (size_t k = 0; k < emitter; ++k) y += p.influence.row(r)[k] * sky;
        p.matte.radiance[r] = y * p.albedo[r] * std::exp(0.2f * normal(random));
        p.matte.sigma[r] = 0.01f * p.matte.radiance[r];
    }
    const auto difference = [&](std::optional<ChromaFraction> chroma) {
        Lighting found = p.start;
        Progress progress;
        AlbedoFreeOptions o;
        o.chroma = chroma;
        for (int stage = 0; stage < 8; ++stage) {  // as a solve does, stage after stage
            o.anneal = stage == 0;
            solveAlbedoFree(p.influence, p.matte, p.pairs, p.anchors, nullptr, o, found, progress, nullptr);
        }
        return test::litDifference(p, found, p.truth);
    };
    EXPECT_LT(difference({}), 0.4 * difference(ChromaFraction{}));
}

}  // namespace
}  // namespace relamp
