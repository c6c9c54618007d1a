#include "brdf/layered_albedo.h"

#include <gtest/gtest.h>

namespace relamp {
namespace {

TEST(LayeredAlbedo, OfAMatteLobeIsOne) {
    EXPECT_NEAR(hemisphericalAlbedo({Lobe::Kind::lambert, 1, "matte"}), 1, 0.005f);
}

TEST(LayeredAlbedo, OfASmoothDielectricIsFresnelsMean) {
    // Schlick's approximation, normal reflectance 0.04: 0.04 + 0.96 / 21 over cosine-distributed directions; roughness
    // takes some of the grazing part.
    const float mean = 0.04f + 0.96f / 21;
    const float coating = hemisphericalAlbedo({Lobe::Kind::ggxDielectric, 0.05f, "glaze"});
    EXPECT_GT(coating, 0.75f * mean);
    EXPECT_LT(coating, mean);
    EXPECT_LT(hemisphericalAlbedo({Lobe::Kind::ggxDielectric, 0.5f, "satin"}), coating);
}

TEST(LayeredAlbedo, OfASharpMirrorIsNearlyOne) {
    for (const float alpha : {0.0036f, 0.01f, 0.05f}) {
        EXPECT_GT(hemisphericalAlbedo({Lobe::Kind::ggx, alpha, "metal"}), 0.98f) << alpha;
        EXPECT_LT(hemisphericalAlbedo({Lobe::Kind::ggx, alpha, "metal"}), 1.005f) << alpha;
    }
}

TEST(LayeredAlbedo, UnderACoatingIsReckonedByWhatGetsThrough) {
    BrdfBasis basis;
    basis.lobes = {{Lobe::Kind::lambert, 1, "matte"}, {Lobe::Kind::ggxDielectric, 0.1f, "glaze"}};
    const float back = hemisphericalAlbedo(basis.lobes[1]);
    const std::vector<Rgb> albedo = albedoUnderCoating(
        basis, {{Rgb(0.4f, 0.1f, 0.05f), Rgb(0.4f), Rgb(0.99f), Rgb(0.2f)}, {Rgb(1), Rgb(0), Rgb(1), Rgb(50)}});
    EXPECT_NEAR(albedo[0].x, 0.4f / (1 - back), 1e-6f);
    EXPECT_NEAR(albedo[0].z, 0.05f / (1 - back), 1e-6f);
    EXPECT_EQ(albedo[1], Rgb(0.4f));  // no coating
    EXPECT_EQ(albedo[2], Rgb(1));
    EXPECT_NEAR(albedo[3].y, 0.2f / 0.3f, 1e-6f);
}

}  // namespace
}  // namespace relamp
