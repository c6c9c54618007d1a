#include "brdf/basis.h"

#include <gtest/gtest.h>

#include <set>

#include "base/error.h"
#include "image/direction_grid.h"

namespace relamp {
namespace {

TEST(BuiltInBasis, StartsWithLambertAndHasItOnce) {
    const BrdfBasis basis = builtInBasis();
    ASSERT_EQ(basis.lobes.size(), 13u);
    EXPECT_EQ(basis.lobes[0].kind, Lobe::Kind::lambert);
    for (size_t k = 1; k < basis.lobes.size(); ++k) EXPECT_NE(basis.lobes[k].kind, Lobe::Kind::lambert);
}

TEST(BuiltInBasis, HasBothGgxKindsOnTheSameGeometricLadderOfRoughness) {
    const BrdfBasis basis = builtInBasis();
    for (size_t k = 1; k <= 6; ++k) {
        EXPECT_EQ(basis.lobes[k].kind, Lobe::Kind::ggx);
        EXPECT_EQ(basis.lobes[k + 6].kind, Lobe::Kind::ggxDielectric);
        EXPECT_EQ(basis.lobes[k].alpha, basis.lobes[k + 6].alpha);
    }
    EXPECT_NEAR(basis.lobes[1].alpha, 0.1 * 0.1, 1e-6);
    EXPECT_NEAR(basis.lobes[6].alpha, 0.7 * 0.7, 1e-6);
    for (size_t k = 1; k < 6; ++k)
        EXPECT_NEAR(basis.lobes[k + 1].alpha / basis.lobes[k].alpha, std::pow(49.0, 0.2), 1e-4);
}

TEST(BuiltInBasis, NamesEachLobeDifferently) {
    std::set<std::string> names;
    for (const Lobe& lobe : builtInBasis().lobes) names.insert(lobe.name);
    EXPECT_EQ(names.size(), 13u);
    EXPECT_TRUE(names.contains("ggx roughness 0.10"));
}

TEST(WideBasis, StartsWithLambertAndNamesEachLobeDifferently) {
    std::set<std::string> names;
    const BrdfBasis basis = wideBasis();
    EXPECT_EQ(basis.lobes[0].kind, Lobe::Kind::lambert);
    for (const Lobe& lobe : basis.lobes) names.insert(lobe.name);
    EXPECT_EQ(names.size(), basis.lobes.size());
    EXPECT_EQ(basis.lobes.size(), 55u);
}

TEST(BasisNamed, KnowsThreeNames) {
    EXPECT_EQ(basisNamed("built-in").lobes.size(), 13u);
    EXPECT_EQ(basisNamed("wide").lobes.size(), 55u);
    EXPECT_EQ(basisNamed("lambert").lobes.size(), 1u);
    EXPECT_THROW(basisNamed("velvet"), Error);
}

TEST(LobeAlbedo, IsTheFractionOfLightSentBackTowardsTheNormal) {
    EXPECT_EQ(lobeAlbedo({Lobe::Kind::ggxDielectric, 0.1f, ""}), 0.04f);
    for (const Lobe& lobe : {Lobe{Lobe::Kind::ward, 0.1f, ""}, Lobe{Lobe::Kind::cookTorrance, 0.2f, ""},
                             Lobe{Lobe::Kind::lafortuneBack, std::sqrt(0.5f), ""}}) {
        const DirectionGrid grid{512};
        double sum = 0;
        for (int c = 0; c < grid.cells(); ++c)
            if (const Vec3 d = grid.direction(c); d.z > 0)
                sum += double(evaluateLobe(lobe, d, {0, 0, 1})) * double(d.z);
        sum *= double(grid.cellSolidAngle());
        EXPECT_NEAR(lobeAlbedo(lobe), sum, 0.03 * sum) << kindName(lobe.kind);
    }
}

TEST(EvaluateLobe, CallsTheModelOfItsKind) {
    const Vec3 light = glm::normalize(Vec3(0.3f, -0.2f, 0.8f)), eye = glm::normalize(Vec3(-0.5f, 0.1f, 0.6f));
    EXPECT_EQ(evaluateLobe({Lobe::Kind::lambert, 1, ""}, light, eye), lambert(light, eye));
    EXPECT_EQ(evaluateLobe({Lobe::Kind::ggx, 0.3f, ""}, light, eye), ggx(light, eye, 0.3f));
    EXPECT_EQ(evaluateLobe({Lobe::Kind::ggxDielectric, 0.3f, ""}, light, eye), ggxDielectric(light, eye, 0.3f, 1.5f));
    EXPECT_EQ(evaluateLobe({Lobe::Kind::ggxGrazing, 0.3f, ""}, light, eye), ggxGrazing(light, eye, 0.3f));
    EXPECT_EQ(evaluateLobe({Lobe::Kind::ward, 0.3f, ""}, light, eye), ward(light, eye, 0.3f));
    EXPECT_EQ(evaluateLobe({Lobe::Kind::cookTorrance, 0.3f, ""}, light, eye), cookTorrance(light, eye, 0.3f));
    EXPECT_NEAR(evaluateLobe({Lobe::Kind::lafortuneBack, 0.5f, ""}, light, eye), lafortune(light, eye, -1, 1, 6),
                1e-6f);
    EXPECT_NEAR(evaluateLobe({Lobe::Kind::lafortuneForward, 0.5f, ""}, light, eye), lafortune(light, eye, 1, 0, 6),
                1e-6f);
    const Lobe a{Lobe::Kind::ggx, 0.3f, ""}, b{Lobe::Kind::ward, 0.2f, ""};
    Lobe mixture{Lobe::Kind::mixture, 0.3f, "both"};
    mixture.parts = {a, b};
    mixture.parts[1].fraction = 0.25f;
    EXPECT_NEAR(evaluateLobe(mixture, light, eye), evaluateLobe(a, light, eye) + 0.25f * evaluateLobe(b, light, eye),
                1e-6f);
}

}  // namespace
}  // namespace relamp
