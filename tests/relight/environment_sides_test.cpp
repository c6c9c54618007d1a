// The environment brighter or darker from six sides.
#include "relight/environment_sides.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "base/error.h"
#include "relight/look.h"
#include "relight/relit_scene.h"
#include "support/estimates.h"

namespace relamp {
namespace {

TEST(EnvironmentSides, ArePartsThatMakeUpAllLight) {
    const Vec3 direction = glm::normalize(Vec3(0.3f, -0.5f, 0.8f));
    float sum = 0;
    for (size_t k = 0; k < sideNames.size(); ++k) sum += sidePart(k, direction);
    EXPECT_NEAR(sum, 1, 1e-6f);
    EXPECT_EQ(sidePart(0, {1, 0, 0}), 1);
    EXPECT_EQ(sidePart(1, {1, 0, 0}), 0);
    EXPECT_EQ(sidePart(5, {0, 0, -1}), 1);
    EnvironmentSides sides = evenSides;
    sides[4] = Rgb(3, 2, 0);
    EXPECT_EQ(sideFactor(sides, {0, 0, 1}), Rgb(3, 2, 0));
    EXPECT_EQ(sideFactor(sides, {0, 0, -1}), Rgb(1));
}

TEST(EnvironmentSides, OfALookDarkenTheEnvironmentFromThere) {
    const Scene scene = test::sceneOf(test::sheet({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, 2, 2));
    const Estimate estimate = test::matteEstimate(scene, Rgb(0.5f), Rgb(2));
    Look look;
    const auto all = distantOfLook(estimate, look.environment);
    look.environment.sides[4] = Rgb(0.25f, 0, 1);
    const auto sided = distantOfLook(estimate, look.environment);
    ASSERT_EQ(sided->cells().size(), all->cells().size());
    for (size_t c = 0; c < all->cells().size(); ++c) {
        const Rgb factor = sideFactor(look.environment.sides, all->grid().direction(int(c)));
        for (int k = 0; k < 3; ++k) EXPECT_NEAR(sided->cells()[c][k], all->cells()[c][k] * factor[k], 1e-5f);
    }
}

TEST(EnvironmentSides, AreReadAndWrittenAndErrorsNameTheField) {
    Look look;
    look.environment.sides[2] = Rgb(0, 0.5f, 2);
    EXPECT_EQ(lookFromJson(lookToJson(look), {}), look);
    EXPECT_FALSE(lookToJson(Look())["environment"].contains("sides"));
    const auto why = [](const nlohmann::json& sides) {
        try {
            lookFromJson({{"environment", {{"sides", sides}}}}, {});
        } catch (const Error& error) { return std::string(error.what()); }
        return std::string();
    };
    EXPECT_EQ(why(3), "environment.sides: expected six lists of three numbers");
    nlohmann::json six = sidesToJson(evenSides);
    six[1][2] = -1;
    EXPECT_EQ(why(six), "environment.sides[1][2]: is -1, expected 0 or more");
    six[1] = {1, 2};
    EXPECT_EQ(why(six), "environment.sides[1]: expected three numbers");
}

}  // namespace
}  // namespace relamp
