#include "viewport/surface_texture.h"

#include <gtest/gtest.h>

#include "display/display_image.h"
#include "display/vertex_images.h"
#include "support/estimates.h"

namespace relamp::ui {
namespace {

/// A sheet with a texture of two colours, left and right, of different confidence.
struct TwoColours {
    const Mesh mesh = test::sheet({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
    const Scene scene = test::sceneOf(mesh);
    Estimate estimate = test::matteEstimate(scene, Rgb(0.5f), Rgb(1));
    std::shared_ptr<AlbedoTexture> texture = std::make_shared<AlbedoTexture>();

    TwoColours() {
        texture->width = texture->height = 16;
        for (int i = 0; i < 256; ++i) {
            texture->texels.push_back(i % 16 < 8 ? Rgb(0.6f, 0.3f, 0.1f) : Rgb(0.2f, 0.4f, 0.8f));
            texture->confidence.push_back(i % 16 < 8 ? 255 : 51);
        }
        for (const Triangle& t : mesh.triangles) {
            texture->corners.emplace_back();
            for (size_t k = 0; k < 3; ++k)
                texture->corners.back()[k] = 2.0f + 12.0f * Vec2(mesh.positions[t[k]].x, mesh.positions[t[k]].y);
        }
        estimate.reflectance.texture = texture;
    }
    static Rgb at(const SurfaceDetail& detail, int x, int y) {
        return Rgb(detail.factor[size_t(y * detail.width + x)]);
    }
};

TEST(SurfaceTexture, TimesTheVerticesItIsTheAlbedo) {
    const TwoColours scene;
    const SurfaceDetail detail = detailOf(scene.estimate, scene.mesh);
    for (const int x : {4, 12})
        EXPECT_LT(glm::length(TwoColours::at(detail, x, 8) * 0.5f - scene.texture->texels[size_t(128 + x)]), 1e-5f);
}

TEST(SurfaceTexture, ConfidenceAndTintsAreThoseOfTheTexels) {
    const TwoColours scene;
    const SurfaceDetail sure = confidenceDetail(scene.estimate), tint = correctionDetail(scene.estimate, scene.mesh);
    EXPECT_EQ(TwoColours::at(sure, 4, 8), confidenceColour(1));
    EXPECT_EQ(TwoColours::at(sure, 12, 8), confidenceColour(0.2f));
    for (const int x : {4, 12})
        EXPECT_LT(glm::length(TwoColours::at(tint, x, 8) - tintOf(scene.texture->texels[size_t(128 + x)])), 1e-5f);
    scene.texture->confidence.clear();
    EXPECT_EQ(confidenceDetail(scene.estimate).width, 0);
}

TEST(SurfaceTexture, LargeOnesAreHalved) {
    TwoColours scene;
    scene.texture->width = 4096, scene.texture->height = 8;
    scene.texture->texels.assign(4096 * 8, Rgb(0.5f));
    scene.texture->confidence.assign(4096 * 8, 255);
    const SurfaceDetail detail = confidenceDetail(scene.estimate);
    EXPECT_EQ(detail.width, 2048);
    EXPECT_EQ(detail.height, 4);
    EXPECT_LT(glm::length(TwoColours::at(detail, 100, 2) - confidenceColour(1)), 1e-6f);
}

}  // namespace
}  // namespace relamp::ui
