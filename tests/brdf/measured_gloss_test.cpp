#include "brdf/measured_gloss.h"

#include <gtest/gtest.h>

#include <cmath>

#include "brdf/basis.h"
#include "support/measured.h"
#include "support/stopping.h"
#include "support/temporary_folder.h"

namespace relamp {
namespace {

const Rgb matteAlbedo(0.3f, 0.2f, 0.1f), tint(1.2f, 1.0f, 0.8f);

Rgb coated(const Vec3& light, const Vec3& eye) { return matteAlbedo / pi + 0.3f * tint * ggx(light, eye, 0.09f); }

TEST(MeasuredGloss, TakesAMaterialApartIntoMattePartAndGloss) {
    const MeasuredGloss gloss = glossOf(test::measuredOf(coated), "coated.binary");
    for (int c = 0; c < 3; ++c) {
        EXPECT_NEAR(gloss.matte[c], matteAlbedo[c], 0.02f);
        EXPECT_NEAR(gloss.colour[c], tint[c], 0.02f);
    }
    EXPECT_GT(gloss.alpha, 0.06f);
    EXPECT_LT(gloss.alpha, 0.14f);
    // Put together again it is the material.
    for (const float angle : {0.0f, 0.4f, 0.8f}) {
        const Vec3 eye(std::sin(angle), 0, std::cos(angle));
        for (const Vec3& light :
             {Vec3(-eye.x, eye.y, eye.z), glm::normalize(Vec3(0.3f, 0.2f, 1)), glm::normalize(Vec3(-0.5f, 0.1f, 1))}) {
            const Rgb wanted = coated(light, eye), found = gloss.matte / pi + gloss.colour * gloss.evaluate(light, eye);
            for (int c = 0; c < 3; ++c) EXPECT_NEAR(found[c], wanted[c], 0.06f * wanted[c]) << angle;
        }
    }
    EXPECT_EQ(gloss.evaluate({0, 0.6f, -0.8f}, {0, 0, 1}), 0);
}

TEST(MeasuredLobes, AreReadFromAFolderInTheOrderOfTheirNames) {
    test::TemporaryFolder folder;
    EXPECT_NE(test::messageOf([&] { readMeasuredLobes(folder.path()); }).find("holds no measured reflectance"),
              std::string::npos);
    EXPECT_NE(test::messageOf([&] { readMeasuredLobes(folder / "nowhere"); }).find("nowhere: cannot be read"),
              std::string::npos);
    folder.write("b-paint.binary", test::merlBytes(coated));
    folder.write("a-cloth.binary", test::merlBytes([](const Vec3&, const Vec3&) { return Rgb(0.1f); }));
    folder.write("notes.txt", "not a material");
    const std::vector<Lobe> lobes = readMeasuredLobes(folder.path());
    ASSERT_EQ(lobes.size(), 2u);
    EXPECT_EQ(lobes[0].name, "a-cloth");
    EXPECT_EQ(lobes[1].name, "b-paint");
    EXPECT_EQ(lobes[1].kind, Lobe::Kind::measured);
    // Cloth that looks alike from everywhere has no gloss.
    EXPECT_NEAR(evaluateLobe(lobes[0], {0, 0, 1}, {0, 0, 1}), 0, 1e-6);
    EXPECT_NEAR(lobes[0].measured->matte.x, 0.1f * pi, 1e-3);
    folder.write("c-short.binary", "too short");
    EXPECT_NE(test::messageOf([&] { readMeasuredLobes(folder.path()); }).find("c-short.binary: is 9 bytes long"),
              std::string::npos);
}

}  // namespace
}  // namespace relamp
