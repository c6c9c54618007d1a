#include "brdf/basis.h"

#include <gtest/gtest.h>

#include <set>

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

TEST(EvaluateLobe, CallsTheModelOfItsKind) {
    const Vec3 light = glm::normalize(Vec3(0.3f, -0.2f, 0.8f)), eye = glm::normalize(Vec3(-0.5f, 0.1f, 0.6f));
    EXPECT_EQ(evaluateLobe({Lobe::Kind::lambert, 1, ""}, light, eye), lambert(light, eye));
    EXPECT_EQ(evaluateLobe({Lobe::Kind::ggx, 0.3f, ""}, light, eye), ggx(light, eye, 0.3f));
    EXPECT_EQ(evaluateLobe({Lobe::Kind::ggxDielectric, 0.3f, ""}, light, eye), ggxDielectric(light, eye, 0.3f, 1.5f));
}

}  // namespace
}  // namespace relamp
