#include "brdf/projection.h"

#include <gtest/gtest.h>

#include <set>

#include "base/parallel.h"

namespace relamp {
namespace {

TEST(NonNegativeLeastSquares, SolvesSmallProblemsWorkedOutByHand) {
    // min (x - 3)^2 + (y + 1)^2: y stays at 0.
    const auto apart = nonNegativeLeastSquares({1, 0, 0, 1}, {3, -1});
    EXPECT_NEAR(apart[0], 3, 1e-9);
    EXPECT_EQ(apart[1], 0);
    // Coupled: without the bound (4, -1) ... A = [2 1; 1 2], b = (7, 2): the free answer is (4, -1), the bound one
    // (3.5, 0).
    const auto x = nonNegativeLeastSquares({2, 1, 1, 2}, {7, 2});
    EXPECT_NEAR(x[0], 3.5, 1e-9);
    EXPECT_EQ(x[1], 0);
    const auto both = nonNegativeLeastSquares({2, 1, 1, 2}, {4, 5});
    EXPECT_NEAR(both[0], 1, 1e-9);
    EXPECT_NEAR(both[1], 2, 1e-9);
    EXPECT_EQ(nonNegativeLeastSquares({2, 1, 1, 2}, {4, 5}, {1})[0], 0);
    EXPECT_EQ(nonNegativeLeastSquares({0, 0, 0, 1}, {0, 2})[0], 0);  // a lobe that shines nowhere
    EXPECT_TRUE(nonNegativeLeastSquares({}, {}).empty());
}

TEST(NonNegativeLeastSquares, MeetsTheConditionsOfTheOptimum) {
    for (uint32_t seed = 1; seed < 30; ++seed) {
        constexpr size_t n = 8, m = 12;
        const auto noise = [&](size_t i) {
            return std::sin(double(seed) * 12.9898 + double(i) * 78.233 + double(i * i % 17));
        };
        std::vector<double> a(m * n), b(m), gram(n * n, 0), moment(n, 0);
        for (size_t i = 0; i < m * n; ++i) a[i] = noise(i);
        for (size_t i = 0; i < m; ++i) b[i] = noise(1000 + i);
        for (size_t i = 0; i < m; ++i)
            for (size_t k = 0; k < n; ++k) {
                moment[k] += a[i * n + k] * b[i];
                for (size_t j = 0; j < n; ++j) gram[k * n + j] += a[i * n + k] * a[i * n + j];
            }
        const std::vector<double> x = nonNegativeLeastSquares(gram, moment);
        for (size_t k = 0; k < n; ++k) {
            double gradient = -moment[k];
            for (size_t j = 0; j < n; ++j) gradient += gram[k * n + j] * x[j];
            EXPECT_GE(x[k], 0);
            EXPECT_GT(gradient, -1e-7);
            EXPECT_TRUE(x[k] == 0 || std::abs(gradient) < 1e-7);
        }
    }
}

TEST(BrdfSamples, CoverTheHemisphereOfLight) {
    // Even light over a white surface: the cosine integrates to pi, less the band near the horizon that is left out.
    for (const int detail : {24, 48}) {
        double sum = 0;
        for (const BrdfSample& s : brdfSamples(detail))
            if (s.towardEye.z == 1) sum += double(s.solidAngle * s.towardLight.z);
        EXPECT_NEAR(sum, piD * (1 - 0.08 * 0.08), 0.05);
    }
}

TEST(BrdfSamples, ErrorsAreThoseWorkedOutByHand) {
    const std::vector<BrdfSample> samples{{Vec3(0, 0, 1), Vec3(0, 0, 1), 2}, {Vec3(0.6f, 0, 0.8f), Vec3(0, 0, 1), 1}};
    const auto [radiance, cube] = brdfErrors(samples, {Rgb(1), Rgb(1.25f)}, {Rgb(8), Rgb(1.25f)});
    EXPECT_NEAR(radiance, std::sqrt(2 * 49.0 / 3), 1e-5);
    EXPECT_NEAR(cube, std::sqrt(2.0 / 3), 1e-5);
}

TEST(Projection, FindsTheWeightsOfAMixtureOfItsOwnLobes) {
    const BrdfBasis basis = builtInBasis();
    const auto mixture = [&](const Vec3& l, const Vec3& e) {
        return Rgb(0.3f, 0.2f, 0.1f) * evaluateLobe(basis.lobes[0], l, e) +
               Rgb(0.5f) * evaluateLobe(basis.lobes[3], l, e) + Rgb(0, 0.4f, 0) * evaluateLobe(basis.lobes[11], l, e);
    };
    Progress progress;
    for (const FitMetric metric : {FitMetric::radiance, FitMetric::cubeRoot}) {
        const BrdfFit fit = projectBrdf(mixture, lobesOf(basis), brdfSamples(), metric, 0, progress);
        EXPECT_LT(fit.radianceError, 1e-4);
        EXPECT_NEAR(fit.weights[0].x, 0.3f, 2e-3);
        EXPECT_NEAR(fit.weights[3].z, 0.5f, 2e-3);
        EXPECT_NEAR(fit.weights[11].y, 0.4f, 1e-2);
        EXPECT_NEAR(fit.weights[11].x, 0, 1e-2);
    }
}

TEST(Projection, PruningFindsTheTwoLobesThatAreThere) {
    const std::vector<NamedLobe> dictionary = lobeDictionary();
    const auto mixture = [&](const Vec3& l, const Vec3& e) {
        return Rgb(0.6f, 0.3f, 0.2f) * dictionary[0].value(l, e) + Rgb(0.2f) * dictionary[17].value(l, e);
    };
    Progress progress;
    const BrdfFit fit = projectBrdf(mixture, dictionary, brdfSamples(), FitMetric::radiance, 2, progress);
    EXPECT_LE(fit.lobes, 2u);
    EXPECT_LT(fit.radianceError, 0.02);
    EXPECT_NEAR(fit.weights[0].x, 0.6f, 0.02);
}

TEST(Projection, SameBitsOnOneAndManyThreads) {
    const auto truth = [](const Vec3& l, const Vec3& e) { return Rgb(ward(l, e, 0.2f)); };
    const auto run = [&](int threads) {
        const ThreadLimit limit(threads);
        Progress progress;
        return projectBrdf(truth, lobeDictionary(), brdfSamples(24), FitMetric::radiance, 4, progress).weights;
    };
    EXPECT_EQ(run(1), run(4));
}

TEST(Projection, CanBeCancelled) {
    Progress progress;
    progress.requestStop();
    EXPECT_THROW(projectBrdf([](const Vec3&, const Vec3&) { return Rgb(1); }, lobeDictionary(), brdfSamples(24),
                             FitMetric::radiance, 4, progress),
                 Cancelled);
}

TEST(LobeDictionary, HasLambertFirstAndEachNameOnce) {
    std::set<std::string> names;
    for (const NamedLobe& lobe : lobeDictionary()) names.insert(lobe.name);
    EXPECT_EQ(names.size(), lobeDictionary().size());
    EXPECT_EQ(lobeDictionary()[0].name, "lambert");
    EXPECT_EQ(names.size(), 73u);
}

}  // namespace
}  // namespace relamp
