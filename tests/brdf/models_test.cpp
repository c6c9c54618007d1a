#include "brdf/models.h"

#include <gtest/gtest.h>

#include <functional>

#include "base/random.h"
#include "image/direction_grid.h"

namespace relamp {
namespace {

using Brdf = std::function<float(const Vec3& towardLight, const Vec3& towardEye)>;

Vec3 direction(double zenithDegrees, double azimuthDegrees = 0) {
    const double t = zenithDegrees * piD / 180, p = azimuthDegrees * piD / 180;
    return Vec3(std::sin(t) * std::cos(p), std::sin(t) * std::sin(p), std::cos(t));
}
Vec3 randomUpper(uint64_t n) {
    const Vec2 u = randomShift(17, n, 0);
    const float r = std::sqrt(std::max(0.0f, 1 - u.x * u.x));
    return {r * std::cos(2 * pi * u.y), r * std::sin(2 * pi * u.y), u.x};
}

/// Integral of f over the upper hemisphere: midpoints of equal steps in cosine and azimuth, so of equal solid angle.
double overHemisphere(const std::function<double(const Vec3&)>& f, int cosines = 500, int azimuths = 1000) {
    double sum = 0;
    for (int i = 0; i < cosines; ++i)
        for (int j = 0; j < azimuths; ++j) {
            const double z = (i + 0.5) / cosines, r = std::sqrt(1 - z * z), p = 2 * piD * (j + 0.5) / azimuths;
            sum += f(Vec3(r * std::cos(p), r * std::sin(p), z));
        }
    return sum * 2 * piD / cosines / azimuths;
}
double albedo(const Brdf& brdf, const Vec3& towardEye) {
    return overHemisphere([&](const Vec3& l) { return double(brdf(l, towardEye)) * double(l.z); });
}

/// The same for a lobe too narrow for uniform steps: over half vectors with tangent width w / (1 - w), in double, so
/// that steps are fine where the lobe is. d(light) = 4 (e . h) d(half vector).
double albedoOfNarrowLobe(const Brdf& brdf, const Vec3& towardEye, double width) {
    const int steps = 800, azimuths = 256;
    const DVec3 eye(towardEye);
    double sum = 0;
    for (int i = 0; i < steps; ++i)
        for (int j = 0; j < azimuths; ++j) {
            const double w = (i + 0.5) / steps, t = width * w / (1 - w), p = 2 * piD * (j + 0.5) / azimuths;
            const double c = 1 / std::sqrt(1 + t * t), s = t * c;
            const DVec3 h(s * std::cos(p), s * std::sin(p), c);
            const double across = glm::dot(eye, h);
            const DVec3 light = 2 * across * h - eye;
            if (across <= 0 || light.z <= 0) continue;
            const double solidAngle = s * c * c * width / ((1 - w) * (1 - w)) / steps * 2 * piD / azimuths;
            sum += double(brdf(Vec3(light), towardEye)) * light.z * 4 * across * solidAngle;
        }
    return sum;
}

TEST(Lambert, ReflectsAllThatArrives) {
    EXPECT_FLOAT_EQ(lambert(direction(30), direction(60)), 0.31830989f);
    EXPECT_NEAR(albedo(lambert, direction(40)), 1, 1e-5);
}

TEST(Ggx, PeaksAtOneOverFourPiAlphaSquaredAtNormalIncidence) {
    const Vec3 up(0, 0, 1);
    EXPECT_FLOAT_EQ(ggx(up, up, 0.5f), 1 / (4 * pi * 0.25f));
    EXPECT_FLOAT_EQ(ggx(up, up, 1.0f), 1 / (4 * pi));
}

TEST(Ggx, NeverReflectsMoreThanArrives) {
    for (const float alpha : {0.01f, 0.05f, 0.25f, 0.5f, 1.0f})
        for (const double zenith : {0.0, 30.0, 60.0, 80.0, 89.0}) {
            const Brdf brdf = [&](const Vec3& l, const Vec3& e) { return ggx(l, e, alpha); };
            EXPECT_LT(albedoOfNarrowLobe(brdf, direction(zenith), double(alpha)), 1.001)
                << "alpha " << alpha << " zenith " << zenith;
        }
}

TEST(Ggx, ReflectsTheClosedFormFractionAtAlphaOne) {
    // D = 1 / pi and the masking is 0.5 / (cos l + cos e), so the albedo is 1 - c ln((1 + c) / c) at eye cosine c.
    const Brdf brdf = [](const Vec3& l, const Vec3& e) { return ggx(l, e, 1); };
    EXPECT_NEAR(albedo(brdf, direction(0)), 1 - std::log(2.0), 1e-4);
    for (const double zenith : {30.0, 60.0, 85.0}) {
        const double c = std::cos(zenith * piD / 180);
        EXPECT_NEAR(albedo(brdf, direction(zenith)), 1 - c * std::log((1 + c) / c), 1e-4) << zenith;
    }
}

TEST(Ggx, ReflectsAlmostAllAtSmallAlpha) {
    for (const double zenith : {0.0, 30.0, 60.0, 75.0}) {
        const Brdf brdf = [](const Vec3& l, const Vec3& e) { return ggx(l, e, 0.01f); };
        EXPECT_NEAR(albedoOfNarrowLobe(brdf, direction(zenith), 0.01), 1, 0.01) << zenith;
    }
}

TEST(Ggx, TwoQuadraturesAgreeOnAWideLobe) {
    const Brdf brdf = [](const Vec3& l, const Vec3& e) { return ggx(l, e, 0.3f); };
    EXPECT_NEAR(albedoOfNarrowLobe(brdf, direction(50), 0.3) / albedo(brdf, direction(50)), 1, 0.002);
}

TEST(Ggx, DielectricIsBareGgxTimesFresnelAtTheHalfVector) {
    const Vec3 light = direction(70, 20), eye = direction(50, 160);
    const float cosine = glm::dot(eye, glm::normalize(light + eye));
    EXPECT_NEAR(ggxDielectric(light, eye, 0.3f) / ggx(light, eye, 0.3f), dielectricFresnel(cosine), 1e-5);
}

TEST(GgxSampling, DensityIntegratesToAtMostOneAndAtNormalIncidenceToTheFractionOfHalfVectorsWithin45Degrees) {
    for (const float alpha : {0.1f, 0.3f, 0.7f})
        for (const double zenith : {0.0, 45.0, 80.0}) {
            const double total =
                overHemisphere([&](const Vec3& l) { return double(ggxSampleDensity(l, direction(zenith), alpha)); });
            EXPECT_LT(total, 1.001) << alpha << " " << zenith;
            EXPECT_GT(total, 0.6) << alpha << " " << zenith;
        }
    for (const float alpha : {0.3f, 0.7f}) {
        const auto density = [&](const Vec3& l) { return double(ggxSampleDensity(l, direction(0), alpha)); };
        EXPECT_NEAR(overHemisphere(density), 1 / (1 + double(alpha) * double(alpha)), 1e-3) << alpha;
    }
}

TEST(GgxSampling, HistogramOfSamplesIsTheDensity) {
    const DirectionGrid grid{8};
    const int samples = 200000, fine = 64;
    for (const float alpha : {0.2f, 0.6f})
        for (const double zenith : {0.0, 40.0, 75.0}) {
            const Vec3 eye = direction(zenith, 25);
            std::vector<int> count(size_t(grid.cells()), 0);
            for (int n = 0; n < samples; ++n) {
                const Vec3 l = sampleGgx(eye, alpha, randomShift(3, uint64_t(n), 1));
                ASSERT_NEAR(glm::length(l), 1, 1e-5);
                if (l.z > 0) ++count[size_t(grid.cellOf(l))];
            }
            for (int cell = 0; cell < grid.cells(); ++cell) {
                double fraction = 0;
                for (int k = 0; k < fine * fine; ++k) {
                    const Vec2 inside((float(k % fine) + 0.5f) / float(fine), (float(k / fine) + 0.5f) / float(fine));
                    fraction += double(ggxSampleDensity(grid.direction(cell, inside), eye, alpha));
                }
                fraction *= double(grid.cellSolidAngle()) / (fine * fine);
                const double found = double(count[size_t(cell)]) / samples;
                EXPECT_NEAR(found, fraction, 5 * std::sqrt(fraction / samples) + 2e-4)
                    << "alpha " << alpha << " zenith " << zenith << " cell " << cell;
            }
        }
}

TEST(GgxSampling, ReflectedEnergyFromSamplesIsThatOfUniformQuadrature) {
    for (const float alpha : {0.1f, 0.3f, 0.7f})
        for (const double zenith : {0.0, 45.0, 75.0}) {
            const Vec3 eye = direction(zenith, 200);
            const Brdf brdf = [&](const Vec3& l, const Vec3& e) { return ggx(l, e, alpha); };
            const int samples = 100000;
            double sum = 0;
            for (int n = 0; n < samples; ++n) {
                const Vec3 l = sampleGgx(eye, alpha, r2Point(uint32_t(n), Vec2(0.3f, 0.6f)));
                const float density = ggxSampleDensity(l, eye, alpha);
                if (density > 0) sum += double(ggx(l, eye, alpha)) * double(l.z) / double(density);
            }
            EXPECT_NEAR(sum / samples / albedo(brdf, eye), 1, 0.01) << "alpha " << alpha << " zenith " << zenith;
        }
}

TEST(GgxSampling, SamplesStayFiniteAtGrazingAndAtTheEdgesOfTheUnitSquare) {
    for (const float alpha : {0.0f, 1e-3f, 0.5f, 1.0f})
        for (const Vec3& eye : {Vec3(0, 0, 1), Vec3(1, 0, 1e-7f), Vec3(0, -1, 1e-30f)})
            for (const Vec2& u :
                 {Vec2(0, 0), Vec2(0x1.fffffep-1f, 0), Vec2(0x1.fffffep-1f, 0.25f), Vec2(0.5f, 0x1.fffffep-1f)}) {
                const Vec3 l = sampleGgx(eye, alpha, u);
                EXPECT_TRUE(isFinite(l));
                EXPECT_NEAR(glm::length(l), 1, 1e-5);
                EXPECT_TRUE(std::isfinite(ggxSampleDensity(l, eye, alpha)));
            }
}

TEST(Fresnel, IsFourPerCentAtNormalIncidenceAndAllAtGrazing) {
    EXPECT_FLOAT_EQ(dielectricFresnel(1, 1.5f), 0.04f);
    EXPECT_FLOAT_EQ(dielectricFresnel(0, 1.5f), 1);
    EXPECT_FLOAT_EQ(dielectricFresnel(1, 1.0f), 0);
}

TEST(Fresnel, ParallelLightVanishesAtBrewstersAngle) {
    const double cosine = 1 / std::sqrt(1 + 1.5 * 1.5);  // tan = 1.5; then s reflects ((n^2 - 1) / (n^2 + 1))^2
    EXPECT_NEAR(dielectricFresnel(float(cosine), 1.5f), 0.5 * std::pow(1.25 / 3.25, 2), 1e-6);
}

TEST(Fresnel, RisesTowardGrazing) {
    for (int k = 0; k < 100; ++k)
        EXPECT_GE(dielectricFresnel(float(k) / 100), dielectricFresnel(float(k + 1) / 100) - 1e-6f);
}

const std::vector<std::pair<const char*, Brdf>>& everyModel() {
    static const std::vector<std::pair<const char*, Brdf>> models{
        {"lambert", lambert},
        {"ggx 0.01", [](const Vec3& l, const Vec3& e) { return ggx(l, e, 0.01f); }},
        {"ggx 0.3", [](const Vec3& l, const Vec3& e) { return ggx(l, e, 0.3f); }},
        {"ggx 0", [](const Vec3& l, const Vec3& e) { return ggx(l, e, 0); }},
        {"ggx dielectric", [](const Vec3& l, const Vec3& e) { return ggxDielectric(l, e, 0.2f); }},
        {"ward", [](const Vec3& l, const Vec3& e) { return ward(l, e, 0.2f); }},
        {"ward 0", [](const Vec3& l, const Vec3& e) { return ward(l, e, 0); }},
        {"lafortune", [](const Vec3& l, const Vec3& e) { return lafortune(l, e, 0.9f, 0.7f, 20); }},
        {"cook-torrance", [](const Vec3& l, const Vec3& e) { return cookTorrance(l, e, 0.3f); }},
        {"cook-torrance 0", [](const Vec3& l, const Vec3& e) { return cookTorrance(l, e, 0); }},
    };
    return models;
}

TEST(EveryModel, IsReciprocalToTheLastBitAndNotNegative) {
    for (const auto& [name, brdf] : everyModel())
        for (uint64_t n = 0; n < 2000; ++n) {
            const Vec3 a = randomUpper(2 * n), b = randomUpper(2 * n + 1);
            ASSERT_EQ(brdf(a, b), brdf(b, a)) << name;
            ASSERT_GE(brdf(a, b), 0) << name;
        }
}

TEST(EveryModel, IsFiniteAtGrazing) {
    std::vector<Vec3> edges{{0, 0, 1}};
    for (const float z : {0x1p-149f, 1e-38f, 1e-20f, 1e-7f, 1e-3f})
        for (const double azimuth : {0.0, 90.0, 137.0, 180.0}) {
            const Vec3 flat = direction(90, azimuth);
            edges.emplace_back(flat.x, flat.y, z);
        }
    for (const auto& [name, brdf] : everyModel())
        for (const Vec3& a : edges)
            for (const Vec3& b : edges) {
                ASSERT_TRUE(std::isfinite(brdf(a, b))) << name << " z " << a.z << " " << b.z;
                ASSERT_GE(brdf(a, b), 0) << name;
            }
}

TEST(EveryModel, IsZeroBelowAndOnTheHorizon) {
    for (const auto& [name, brdf] : everyModel())
        for (const Vec3& below : {direction(95), direction(180), Vec3(1, 0, 0)}) {
            EXPECT_EQ(brdf(below, direction(20)), 0) << name;
            EXPECT_EQ(brdf(direction(20), below), 0) << name;
        }
}

TEST(Ward, ReflectsAtMostOneAndAlmostAllAtSmallWidth) {
    for (const double zenith : {0.0, 45.0, 70.0, 85.0})
        for (const float alpha : {0.02f, 0.1f, 0.3f, 0.5f}) {
            const Brdf brdf = [&](const Vec3& l, const Vec3& e) { return ward(l, e, alpha); };
            EXPECT_LT(albedoOfNarrowLobe(brdf, direction(zenith), double(alpha)), 1.001) << zenith << " " << alpha;
        }
    const Brdf narrow = [](const Vec3& l, const Vec3& e) { return ward(l, e, 0.02f); };
    EXPECT_NEAR(albedoOfNarrowLobe(narrow, direction(45), 0.02), 1, 0.01);
}

TEST(CookTorrance, ReflectsAtMostOneAndAlmostAllAtSmallSlope) {
    for (const double zenith : {0.0, 45.0, 70.0, 85.0})
        for (const float m : {0.02f, 0.1f, 0.3f, 0.5f}) {
            const Brdf brdf = [&](const Vec3& l, const Vec3& e) { return cookTorrance(l, e, m); };
            EXPECT_LT(albedoOfNarrowLobe(brdf, direction(zenith), double(m)), 1.001) << zenith << " " << m;
        }
    const Brdf narrow = [](const Vec3& l, const Vec3& e) { return cookTorrance(l, e, 0.02f); };
    EXPECT_NEAR(albedoOfNarrowLobe(narrow, direction(45), 0.02), 1, 0.01);
}

TEST(Lafortune, IsOneInTheMirrorDirectionWhenBothCoefficientsAreOne) {
    EXPECT_NEAR(lafortune(direction(40, 10), direction(40, 190), 1, 1, 30), 1, 1e-5);
    EXPECT_LT(lafortune(direction(40, 10), direction(40, 10), 1, 1, 30), 1e-5);
}

TEST(GgxGrazing, IsGgxTimesTheFifthPowerAtTheHalfVector) {
    const Vec3 light = glm::normalize(Vec3(0.6f, 0, 0.8f)), eye = glm::normalize(Vec3(-0.6f, 0, 0.8f));
    // The half vector is the normal, its cosine 0.8.
    EXPECT_NEAR(ggxGrazing(light, eye, 0.2f) / ggx(light, eye, 0.2f), std::pow(0.2, 5), 1e-8);
    EXPECT_EQ(ggxGrazing(light, {0, 0, -1}, 0.2f), 0);
    EXPECT_EQ(ggxGrazing(light, eye, 0.2f), ggxGrazing(eye, light, 0.2f));
}

}  // namespace
}  // namespace relamp
