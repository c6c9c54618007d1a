// Colours that a mesh's own file has: read from images and vertices, and held against the photographs.
#include "capture/mesh_colours.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "capture/check.h"
#include "scene/mesh_io.h"
#include "support/shaken_sheet.h"
#include "support/temporary_folder.h"

namespace relamp {
namespace {

/// A capture of nothing but a mesh.
struct PaintedMesh {
    Capture capture;
    Progress progress;
    explicit PaintedMesh(const std::filesystem::path& file) {
        std::vector<TexturedFace> faces;
        MeshPaint paint;
        capture.mesh = readMesh(file, nullptr, {}, &faces, &paint);
        capture.texcoords = std::make_shared<const std::vector<TexturedFace>>(faces);
        capture.paint = std::make_shared<const MeshPaint>(paint);
    }
    MeshColours colours() { return meshColours(capture, progress); }
};

/// Left half red, right half blue, as a PNG.
std::string redAndBlue() {
    Image image(16, 8);
    for (int y = 0; y < 8; ++y)
        for (int x = 0; x < 16; ++x) image.at(x, y) = x < 8 ? Rgb(0.5f, 0, 0) : Rgb(0, 0, 0.25f);
    return encodePng(image);
}

/// Four vertices of a square: the left ones red, the right ones blue.
void expectRedAndBlue(const MeshColours& colours, size_t images) {
    ASSERT_EQ(colours.linear.size(), 4u);
    EXPECT_EQ(colours.images, images);
    EXPECT_TRUE(colours.faults.empty());
    for (const size_t left : {0, 3}) {
        EXPECT_NEAR(colours.linear[left].x, 0.5f, 0.01f);
        EXPECT_EQ(colours.linear[left].z, 0);
    }
    for (const size_t right : {1, 2}) {
        EXPECT_EQ(colours.linear[right].x, 0);
        EXPECT_NEAR(colours.linear[right].z, 0.25f, 0.01f);
    }
    for (const uint8_t p : colours.painted) EXPECT_EQ(p, 1);
}

/// Texture coordinates near the middles of the halves, so that no face has both colours but at its edges.
constexpr const char* objSquare =
    "mtllib square of two.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0.5 0 0\nv 0.5 1 0\n"
    "vt 0.1 0.1\nvt 0.4 0.9\nvt 0.6 0.1\nvt 0.9 0.9\nusemtl two colours\n"
    "f 1/1 5/2 6/2 4/1\nf 5/3 2/4 3/4 6/3\n";

TEST(MeshColours, AnObjTakesThemFromTheImageOfItsMaterial) {
    const test::TemporaryFolder folder;
    folder.write("tex/red and blue.png", redAndBlue());
    folder.write(
        "square of two.mtl",
        "newmtl other\nmap_Kd missing.png\nnewmtl two colours\nKd 1 1 1\nmap_Kd -clamp on tex\\red and blue.png\n");
    PaintedMesh square(folder.write("a.obj", objSquare));
    MeshColours colours = square.colours();
    colours.linear.resize(4);
    colours.painted.resize(4);
    expectRedAndBlue(colours, 1);
    EXPECT_EQ(filesBesideMesh(folder / "a.obj"),
              (std::vector{folder / "square of two.mtl", folder / "missing.png", folder / "tex/red and blue.png"}));
    // An image that is not there is named; the mesh stays.
    std::filesystem::remove(folder / "tex/red and blue.png");
    const MeshColours without = PaintedMesh(folder / "a.obj").colours();
    EXPECT_TRUE(without.empty());
    ASSERT_EQ(without.faults.size(), 1u);
    EXPECT_NE(without.faults[0].find("red and blue.png: does not exist"), std::string::npos) << without.faults[0];
    // Without its library it is a mesh all the same.
    std::filesystem::remove(folder / "square of two.mtl");
    EXPECT_TRUE(PaintedMesh(folder / "a.obj").colours().empty());
}

TEST(MeshColours, APlyHasThemInVerticesOrAnImage) {
    const test::TemporaryFolder folder;
    const std::string head = "ply\nformat ascii 1.0\n", vertices =
                                                            "element vertex 4\nproperty float x\nproperty float y\n"
                                                            "property float z\n";
    const std::string face = "element face 1\nproperty list uchar int vertex_indices\n";
    const auto code = [](float linear) { return std::to_string(int(std::lround(srgbEncode(linear) * 255))); };
    const std::string red = " " + code(0.5f) + " 0 0\n", blue = " 0 0 " + code(0.25f) + "\n";
    PaintedMesh square(folder.write(
        "a.ply", head + vertices + "property uchar red\nproperty uchar green\nproperty uchar blue\n" + face +
                     "end_header\n0 0 0" + red + "1 0 0" + blue + "1 1 0" + blue + "0 1 0" + red + "4 0 1 2 3\n"));
    expectRedAndBlue(square.colours(), 0);
    // The file's image goes before colours of vertices, where a face has texture coordinates.
    folder.write("b.png", redAndBlue());
    PaintedMesh textured(
        folder.write("b.ply", head + "comment TextureFile b.png\n" + vertices + face +
                                  "property list uchar float texcoord\nend_header\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n"
                                  "4 0 1 2 3 8 0.1 0.1 0.4 0.1 0.4 0.9 0.1 0.9\n"));
    const MeshColours colours = textured.colours();
    ASSERT_EQ(colours.linear.size(), 4u);
    for (const Rgb& c : colours.linear) EXPECT_NEAR(c.x, 0.5f, 0.01f);
    EXPECT_EQ(filesBesideMesh(folder / "b.ply"), (std::vector{folder / "b.png"}));
}

TEST(MeshColours, AnObjMayHaveThemBesideItsVertices) {
    const test::TemporaryFolder folder;
    for (const float unit : {1.0f, 255.0f}) {
        const auto vertex = [&](const char* place, const Rgb& c) {
            return fmt::format("v {} {} {} {}\n", place, srgbEncode(c.x) * unit, srgbEncode(c.y) * unit,
                               srgbEncode(c.z) * unit);
        };
        const Rgb red(0.5f, 0, 0), blue(0, 0, 0.25f);
        PaintedMesh square(folder.write("a.obj", vertex("0 0 0", red) + vertex("1 0 0", blue) + vertex("1 1 0", blue) +
                                                     vertex("0 1 0", red) + "f 1 2 3 4\n"));
        expectRedAndBlue(square.colours(), 0);
    }
    EXPECT_TRUE(PaintedMesh(folder.write("b.obj", "v 0 0 0 1\nv 1 0 0 1\nv 1 1 0 1 x y\nf 1 2 3\n")).colours().empty());
}

/// The square of the OBJ as a .glb with its image inside, or beside it.
std::string glbSquare(const std::string& image, bool beside) {
    using nlohmann::json;
    std::string buffer;
    json root{{"asset", {{"version", "2.0"}}},
              {"nodes", {{{"mesh", 0}}}},
              {"materials", {{{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}}}},
              {"textures", {{{"source", 0}}}}};
    const auto add = [&](const auto& values, int type, const char* shape, size_t count) {
        root["accessors"].push_back(
            {{"bufferView", root["bufferViews"].size()}, {"componentType", type}, {"count", count}, {"type", shape}});
        const size_t size = values.size() * sizeof(values[0]);
        root["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", buffer.size()}, {"byteLength", size}});
        buffer.append(reinterpret_cast<const char*>(values.data()), size);
        while (buffer.size() % 4) buffer.push_back(0);
    };
    add(std::vector<float>{0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 0.5f, 0, 0, 0.5f, 1, 0, 0.5f, 0, 0, 0.5f, 1, 0}, 5126,
        "VEC3", 8);
    add(std::vector<float>{0.1f, 0.9f, 0.9f, 0.1f, 0.9f, 0.1f, 0.1f, 0.9f, 0.4f, 0.1f, 0.4f, 0.1f, 0.6f, 0.9f, 0.6f,
                           0.9f},
        5126, "VEC2", 8);
    add(std::vector<uint16_t>{0, 4, 5, 0, 5, 3, 6, 1, 2, 6, 2, 7}, 5123, "SCALAR", 12);
    root["meshes"] = {
        {{"primitives", {{{"attributes", {{"POSITION", 0}, {"TEXCOORD_0", 1}}}, {"indices", 2}, {"material", 0}}}}}};
    if (beside) root["images"] = {{{"uri", "red%20and%20blue.png"}}};
    else {
        root["images"] = {{{"bufferView", 3}, {"mimeType", "image/png"}}};
        root["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", buffer.size()}, {"byteLength", image.size()}});
        buffer += image;
        while (buffer.size() % 4) buffer.push_back(0);
    }
    root["buffers"] = {{{"byteLength", buffer.size()}}};
    std::string text = root.dump();
    while (text.size() % 4) text.push_back(' ');
    const auto word = [](size_t value) {
        const auto v = uint32_t(value);
        return std::string(reinterpret_cast<const char*>(&v), 4);
    };
    return "glTF" + word(2) + word(28 + text.size() + buffer.size()) + word(text.size()) + "JSON" + text +
           word(buffer.size()) + std::string("BIN\0", 4) + buffer;
}

TEST(MeshColours, AGlbHoldsItsImageOrNamesIt) {
    const test::TemporaryFolder folder;
    folder.write("red and blue.png", redAndBlue());
    for (const bool beside : {false, true}) {
        PaintedMesh square(folder.write("a.glb", glbSquare(redAndBlue(), beside)));
        MeshColours colours = square.colours();
        colours.linear.resize(4);
        colours.painted.resize(4);
        expectRedAndBlue(colours, 1);
        EXPECT_EQ(filesBesideMesh(folder / "a.glb").size(), size_t(beside));
    }
    // One that is cut off is named, and the mesh stays.
    const std::string whole = redAndBlue();
    PaintedMesh cut(folder.write("a.glb", glbSquare(whole.substr(0, whole.size() / 2), false)));
    const MeshColours colours = cut.colours();
    EXPECT_TRUE(colours.empty());
    ASSERT_EQ(colours.faults.size(), 1u);
    EXPECT_NE(colours.faults[0].find("a.glb: its image: "), std::string::npos)
        << colours.faults[0];
}

/// The sheet with its print as colours of its vertices.
Capture printedSheet() {
    Capture capture = test::ShakenSheet().capture;
    MeshPaint paint;
    paint.linear = true;
    for (const Vec3& p : capture.mesh.positions) paint.colours.emplace_back(test::ShakenSheet::print(p.x, p.y));
    capture.paint = std::make_shared<const MeshPaint>(paint);
    return capture;
}

TEST(MeshColours, PhotographsThatLieOffThemAreNoticed) {
    Capture capture = printedSheet();
    Progress progress;
    const CaptureCheck right = checkCapture(capture, progress);
    ASSERT_TRUE(right.colours.has_value());
    EXPECT_EQ(right.colours->views, 8u);
    EXPECT_GT(right.colours->correlation, 0.9);
    EXPECT_LT(right.colours->shift, 0.3);
    EXPECT_LT(right.colours->worstShift, 0.5);
    // Other light changes slowly from place to place, and has no part in it.
    for (View& view : capture.views)
        for (int y = 0; y < view.image.height; ++y)
            for (int x = 0; x < view.image.width; ++x)
                view.image.at(x, y) *= 0.2f + 3 * float(x) / float(view.image.width);
    for (View& view : capture.views) view.camera.centreX += 4, view.camera.centreY -= 3;
    const CaptureCheck off = checkCapture(capture, progress);
    ASSERT_TRUE(off.colours.has_value());
    std::printf("off by 5 pixels: found %.2f, at most %.2f, correlation %.3f\n", off.colours->shift,
                off.colours->worstShift, off.colours->correlation);
    EXPECT_NEAR(off.colours->shift, 5, 0.4);
    EXPECT_NEAR(off.colours->worstShift, 5, 0.6);
    EXPECT_TRUE(std::any_of(off.warnings.begin(), off.warnings.end(), [](const std::string& w) {
        return w.find("pixels from the mesh's own colours (median of 8 views;") != w.npos;
    }));
    EXPECT_EQ(toJson(off)["mesh_colours"]["views"], 8);
}

TEST(MeshColours, OneCameraThatLiesOffIsNamed) {
    Capture capture = printedSheet();
    capture.views[5].camera.centreX += 7;
    Progress progress;
    const CaptureCheck check = checkCapture(capture, progress);
    ASSERT_TRUE(check.colours.has_value());
    EXPECT_EQ(check.colours->worstView, "5");
    EXPECT_NEAR(check.colours->worstShift, 7, 0.6);
    EXPECT_TRUE(std::any_of(check.warnings.begin(), check.warnings.end(),
                            [](const std::string& w) { return w.rfind("5: lies ", 0) == 0; }));
}

}  // namespace
}  // namespace relamp
