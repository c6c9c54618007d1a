#include "texture/own_charts.h"

#include <gtest/gtest.h>

#include <limits>

#include "support/shapes.h"
#include "texture/seams.h"
#include "texture/vertex_texels.h"

namespace relamp {
namespace {

/// A sheet of 2 m x 1 m whose place on the image is `place` of its own coordinates in [0, 1].
struct PlacedSheet {
    Mesh mesh = test::sheet({0, 0, 0}, {2, 0, 0}, {0, 1, 0}, 8, 4);
    std::vector<TexturedFace> faces;

    template <class Place>
    explicit PlacedSheet(Place&& place) {
        for (const Triangle& t : mesh.triangles) {
            TexturedFace face{t, {}};
            for (size_t k = 0; k < 3; ++k)
                face.texcoords[k] = place(Vec2(mesh.positions[t[k]].x / 2, mesh.positions[t[k]].y));
            faces.push_back(face);
        }
    }
    OwnCharts own() const { return ownCharts(mesh, faces); }
    Atlas laidOut(float density, std::string& why, int mostSide = 4096) const {
        OwnCharts charts = own();
        EXPECT_EQ(charts.why, "");
        AtlasOptions options;
        options.mostSide = mostSide;
        const Atlas atlas = layOutOwn(mesh, charts, std::vector<float>(mesh.triangles.size(), density), options);
        why = charts.why;
        return atlas;
    }
};

Vec2 middle(const Vec2& p) { return Vec2(0.1f) + 0.8f * p; }

TEST(OwnCharts, AreTheAtlasAsTheFileHasThem) {
    const PlacedSheet sheet(middle);
    std::string why;
    const Atlas atlas = sheet.laidOut(100, why);
    EXPECT_EQ(why, "");
    EXPECT_EQ(atlas.charts, 1u);
    // As many texels as are asked for: 2 m2 with 1e4 a m2, on 0.64 of the image.
    EXPECT_NEAR(atlas.width, std::sqrt(2e4 / 0.64), 16);
    EXPECT_EQ(atlas.height, atlas.width);
    EXPECT_FLOAT_EQ(atlas.scale, 1);
    for (size_t t = 0; t < sheet.faces.size(); ++t)
        for (size_t k = 0; k < 3; ++k) {
            const Vec2 uv = sheet.faces[t].texcoords[k];
            EXPECT_LT(glm::distance(atlas.corners[t][k], Vec2(uv.x, 1 - uv.y) * float(atlas.width)), 1e-4f);
        }
}

TEST(OwnCharts, ThatLieOnOneAnotherAreNotUsed) {
    const std::string mirrored = PlacedSheet([](const Vec2& p) {
                                     return middle({std::abs(p.x - 0.5f), p.y});
                                 })
                                     .own()
                                     .why;
    EXPECT_EQ(mirrored, "triangles lie on one another in the image");
    // All in one place, as a hostile file has them.
    Mesh mesh;
    std::vector<TexturedFace> faces;
    for (uint32_t i = 0; i < 3000; ++i) {
        for (const Vec3& p : {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0)}) mesh.positions.push_back(p);
        mesh.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
        faces.push_back({mesh.triangles.back(), {Vec2(0, 0), Vec2(1, 0), Vec2(0, 1)}});
    }
    EXPECT_EQ(ownCharts(mesh, faces).why, mirrored);
}

TEST(OwnCharts, OutsideTheImageOrMissingAreNotUsed) {
    EXPECT_EQ(PlacedSheet([](const Vec2& p) { return 2.0f * p; }).own().why,
              "75 % of the surface lies outside the image, as tiles do");
    const float bad = std::numeric_limits<float>::quiet_NaN();
    EXPECT_EQ(PlacedSheet([&](const Vec2&) { return Vec2(bad, 1e30f); }).own().why,
              "100 % of the surface lies outside the image, as tiles do");
    PlacedSheet sheet(middle);
    sheet.faces.resize(48);
    EXPECT_EQ(sheet.own().why, "25 % of the surface has none");
    // A few may be missing, and have no texels.
    PlacedSheet nearly(middle);
    nearly.faces.pop_back();
    std::string why;
    const Atlas atlas = nearly.laidOut(50, why);
    EXPECT_GE(atlas.corners[0][0].x, 0);
    EXPECT_LT(atlas.corners.back()[0].x, 0);
}

TEST(OwnCharts, CloserThanTexelsAreNotUsed) {
    // Every square is a chart of its own, a hundredth of the image away from the next one.
    const auto squares = [](int t, const Vec2& p) {
        const Vec2 cell(float(t / 2 % 8), float(t / 16));
        return (cell + 0.04f + 0.92f * (p * Vec2(8, 4) - cell)) / 8.0f;
    };
    PlacedSheet sheet(middle);
    for (size_t t = 0; t < sheet.faces.size(); ++t)
        for (size_t k = 0; k < 3; ++k) {
            const Vec3& p = sheet.mesh.positions[sheet.faces[t].corners[k]];
            sheet.faces[t].texcoords[k] = squares(int(t), Vec2(p.x / 2, p.y));
        }
    std::string why;
    const Atlas fine = sheet.laidOut(400, why);
    EXPECT_EQ(why, "");
    EXPECT_EQ(fine.charts, 32u);
    EXPECT_EQ(sheet.laidOut(20, why).width, 0);
    EXPECT_NE(why.find("closer together than the texels"), std::string::npos) << why;
}

TEST(OwnCharts, ThatWasteTheImageAreNotUsed) {
    const PlacedSheet corner([](const Vec2& p) { return 0.05f * p; });
    std::string why;
    EXPECT_EQ(corner.laidOut(500, why, 1024).width, 0);
    EXPECT_NE(why.find("of the photographs' resolution"), std::string::npos) << why;
}

/// Half of the files lay charts out mirrored, and none but ours with v downwards.
TEST(OwnCharts, MirroredOnesHoldWhatVerticesSay) {
    for (const bool mirrored : {false, true}) {
        const PlacedSheet sheet([&](const Vec2& p) { return middle({mirrored ? 1 - p.x : p.x, p.y}); });
        std::string why;
        const Atlas atlas = sheet.laidOut(40, why);
        AlbedoTexture texture{atlas.width, atlas.height, atlas.corners, {}};
        std::vector<Rgb> values;
        for (const Vec3& p : sheet.mesh.positions) values.push_back(Rgb(p.x, p.y, 1));
        texture.texels = texelsOfVertices(sheet.mesh, values, texture);
        for (uint32_t t = 0; t < sheet.mesh.triangles.size(); ++t) {
            const Rgb found = texture.at(texture.place(t, {1 / 3.0f, 1 / 3.0f}));
            Rgb wanted(0);
            for (const uint32_t v : sheet.mesh.triangles[t]) wanted += values[v] / 3.0f;
            EXPECT_LT(glm::distance(found, wanted), 1e-3f) << t << mirrored;
        }
    }
}

/// The edge between two triangles whose vertices a writer split, because they lie apart on the image.
TEST(OwnCharts, SeamsLieWhereVerticesAreSplit) {
    Mesh mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 0, 0}, {1, 1, 0}, {-0.0f, 1, 0}};
    mesh.triangles = {{0, 1, 2}, {3, 4, 5}};
    mesh.normals.assign(6, Vec3(0, 0, 1));
    AlbedoTexture texture{40, 20, {}, std::vector<Rgb>(800, Rgb(0.5f))};
    texture.corners = {{Vec2(2, 2), Vec2(12, 2), Vec2(2, 12)}, {Vec2(32, 2), Vec2(32, 12), Vec2(22, 12)}};
    const std::vector<SeamPoint> seams = seamPoints(mesh, texture);
    ASSERT_GT(seams.size(), 10u);
    for (const SeamPoint& p : seams) EXPECT_LT(glm::distance(p.there, p.here + Vec2(20, 0)), 1e-4f);
    mesh.normals[3] = mesh.normals[4] = mesh.normals[5] = Vec3(1, 0, 0);  // a crease
    EXPECT_TRUE(seamPoints(mesh, texture).empty());
}

}  // namespace
}  // namespace relamp
