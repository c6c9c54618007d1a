#include "shot/shot_texture.h"

#include <gtest/gtest.h>

#include "base/error.h"
#include "support/shapes.h"
#include "support/temporary_folder.h"

namespace relamp {
namespace {

AlbedoTexture smallTexture() {
    AlbedoTexture texture{8, 4, {}, std::vector<Rgb>(32, Rgb(0))};
    for (size_t i = 0; i < 32; ++i) texture.texels[i] = Rgb(float(i) / 64, 0.25f, 0.5f);
    texture.corners = {{Vec2(1, 1), Vec2(7, 1), Vec2(1, 3)}, {Vec2(-1), Vec2(-1), Vec2(-1)}};
    return texture;
}

class ShotTexture : public testing::Test {
protected:
    ShotTexture() {
        std::vector<FaceTexcoords> texcoords;
        for (uint32_t t = 0; t < 2; ++t) texcoords.push_back(texcoordsOf(texture, t));
        writeVertexPly(folder / "reflectance.ply", mesh, {}, DVec3(0), texcoords);
        writeTexture(texture, folder / "albedo.exr");
    }
    std::shared_ptr<const AlbedoTexture> read(const std::vector<Triangle>& triangles) const {
        return readTexture(folder / "albedo.exr", readTexturedFaces(folder / "reflectance.ply"), triangles);
    }
    const test::TemporaryFolder folder;
    const Mesh mesh = test::sheet({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
    const AlbedoTexture texture = smallTexture();
};

TEST_F(ShotTexture, ComesBackAsItWas) {
    const auto found = read(mesh.triangles);
    ASSERT_TRUE(found);
    EXPECT_EQ(found->width, 8);
    EXPECT_EQ(found->height, 4);
    for (size_t i = 0; i < 32; ++i) EXPECT_LT(glm::length(found->texels[i] - texture.texels[i]), 1e-3f);
    for (size_t k = 0; k < 3; ++k) EXPECT_LT(glm::length(found->corners[0][k] - texture.corners[0][k]), 1e-5f);
    EXPECT_TRUE(found->has(0));
    EXPECT_FALSE(found->has(1));
}

TEST_F(ShotTexture, FollowsTheCornersOfAFaceThatIsTurnedOrElsewhereInTheList) {
    const Triangle t = mesh.triangles[0];
    const auto found = read({mesh.triangles[1], {t[2], t[1], t[0]}});
    ASSERT_TRUE(found->has(1));
    for (size_t k = 0; k < 3; ++k) EXPECT_LT(glm::length(found->corners[1][2 - k] - texture.corners[0][k]), 1e-5f);
}

TEST_F(ShotTexture, AMeshThatOtherProgramsReadStaysTheSame) {
    MeshReport report;
    const Mesh read = readMesh(folder / "reflectance.ply", &report);
    EXPECT_EQ(read.triangles, mesh.triangles);
}

TEST_F(ShotTexture, WithoutTexcoordsThereIsNone) {
    writeVertexPly(folder / "reflectance.ply", mesh, {});
    EXPECT_FALSE(read(mesh.triangles));
}

TEST_F(ShotTexture, ConfidenceComesBackAndShotsWithoutItAreRead) {
    AlbedoTexture known = texture;
    for (size_t i = 0; i < 32; ++i) known.confidence.push_back(uint8_t(8 * i + 7));
    const auto file = folder / "albedo_confidence.exr";
    const auto both = [&] {
        return readTexture(folder / "albedo.exr", readTexturedFaces(folder / "reflectance.ply"), mesh.triangles, file);
    };
    EXPECT_TRUE(both()->confidence.empty());
    EXPECT_EQ(both()->confidenceAt({3, 2}), 1);
    writeTextureConfidence(known, file);
    EXPECT_EQ(both()->confidence, known.confidence);
    known.width = 4;
    known.confidence.resize(16);
    writeTextureConfidence(known, file);
    try {
        both();
        FAIL();
    } catch (const Error& error) {
        EXPECT_NE(std::string(error.what()).find("albedo_confidence.exr"), std::string::npos);
    }
}

TEST_F(ShotTexture, BadFilesAreNamed) {
    folder.write("albedo.exr", "no picture");
    try {
        read(mesh.triangles);
        FAIL();
    } catch (const Error& error) { EXPECT_NE(std::string(error.what()).find("albedo.exr"), std::string::npos); }
}

TEST_F(ShotTexture, TexcoordsThatAreNoNumbersAreNone) {
    std::vector<FaceTexcoords> wild(2, FaceTexcoords{Vec2(NAN, 0.5f), Vec2(1e30f, -1e30f), Vec2(0.5f)});
    writeVertexPly(folder / "reflectance.ply", mesh, {}, DVec3(0), wild);
    const auto found = read(mesh.triangles);
    EXPECT_FALSE(found && found->has(0));
}

}  // namespace
}  // namespace relamp
