#include <gtest/gtest.h>

#include <cstring>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "scene/mesh_io.h"
#include "support/temporary_folder.h"

namespace relamp {
namespace {

using nlohmann::json;

template <class T>
std::string packedBytes(const std::vector<T>& values) {
    return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
}

/// A square of two triangles in z = 0 with texture coordinates, split along nothing.
struct SquareFile {
    std::string buffer;
    json root;

    explicit SquareFile(const std::string& indices = packedBytes<uint16_t>({0, 1, 2, 0, 2, 3}), int indexType = 5123) {
        root = {{"asset", {{"version", "2.0"}}},
                {"scene", 0},
                {"scenes", {{{"nodes", {0}}}}},
                {"nodes", {{{"mesh", 0}}}},
                {"meshes",
                 {{{"primitives",
                    {{{"attributes", {{"POSITION", 0}, {"NORMAL", 1}, {"TEXCOORD_0", 2}}}, {"indices", 3}}}}}}}};
        add(packedBytes<float>({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0}), 5126, "VEC3", 4);
        add(packedBytes<float>({0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1}), 5126, "VEC3", 4);
        add(packedBytes<float>({0, 1, 1, 1, 1, 0, 0, 0}), 5126, "VEC2", 4);
        add(indices, indexType, "SCALAR", 6);
    }
    void add(const std::string& bytes, int type, const char* shape, size_t count) {
        while (buffer.size() % 4) buffer.push_back(0);
        root["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", buffer.size()}, {"byteLength", bytes.size()}});
        root["accessors"].push_back({{"bufferView", root["bufferViews"].size() - 1},
                                     {"componentType", type},
                                     {"count", count},
                                     {"type", shape}});
        buffer += bytes;
    }
    json& primitive() { return root["meshes"][0]["primitives"][0]; }

    std::string glb() const {
        json document = root;
        document["buffers"] = {{{"byteLength", buffer.size()}}};
        std::string text = document.dump(), padded = buffer;
        while (text.size() % 4) text.push_back(' ');
        while (padded.size() % 4) padded.push_back(0);
        const auto word = [](size_t value) { return packedBytes<uint32_t>({uint32_t(value)}); };
        return "glTF" + word(2) + word(28 + text.size() + padded.size()) + word(text.size()) + "JSON" + text +
               word(padded.size()) + std::string("BIN\0", 4) + padded;
    }
    std::string gltf(const std::string& uri) const {
        json document = root;
        document["buffers"] = {{{"byteLength", buffer.size()}, {"uri", uri}}};
        return document.dump();
    }
    std::string embedded() const {
        constexpr const char* digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
        std::string text;
        for (size_t i = 0; i < buffer.size(); i += 3) {
            uint32_t bits = 0;
            for (size_t k = 0; k < 3; ++k)
                bits = bits << 8 | (i + k < buffer.size() ? static_cast<unsigned char>(buffer[i + k]) : 0u);
            for (size_t k = 0; k < 4; ++k)
                text.push_back(i + k > buffer.size() ? '=' : digits[bits >> (18 - 6 * k) & 63]);
        }
        return gltf("data:application/octet-stream;base64," + text);
    }
};

std::string refusalOf(const std::string& bytes, const std::string& name = "mesh.glb", const MeshLimits& limits = {}) {
    static const test::TemporaryFolder folder;
    const auto file = folder.write(name, bytes);
    std::string message = test::messageOf([&] { readMesh(file, nullptr, limits); });
    if (message.rfind(file.string() + ": ", 0) == 0) message.erase(0, file.string().size() + 2);
    return message;
}

std::string refusalOf(const SquareFile& file) { return refusalOf(file.glb()); }

struct Read {
    MeshReport report;
    std::vector<TexturedFace> texcoords;
    Mesh mesh;
    explicit Read(const SquareFile& file) : Read(test::TemporaryFolder(), "mesh.glb", file.glb()) {}
    Read(const test::TemporaryFolder& folder, const std::string& name, const std::string& bytes)
        : mesh(readMesh(folder.write(name, bytes), &report, {}, &texcoords)) {}
};

void expectSquare(const Read& read) {
    ASSERT_EQ(read.mesh.vertexCount(), 4u);
    ASSERT_EQ(read.mesh.triangles.size(), 2u);
    EXPECT_EQ(read.mesh.positions[2], Vec3(1, 1, 0));
    EXPECT_EQ(read.mesh.triangles[1], (Triangle{0, 2, 3}));
    EXPECT_EQ(read.mesh.normals[3], Vec3(0, 0, 1));
    EXPECT_TRUE(read.report.normalsFromFile);
    EXPECT_TRUE(read.report.yUp);
    ASSERT_EQ(read.texcoords.size(), 2u);
    EXPECT_EQ(read.texcoords[1].corners, (Triangle{0, 2, 3}));
    EXPECT_EQ(read.texcoords[1].texcoords, (FaceTexcoords{Vec2(0, 0), Vec2(1, 1), Vec2(0, 1)}));  // v is up here
}

TEST(GltfReader, BuffersMayBeInsideInTextOrBeside) {
    const test::TemporaryFolder folder;
    const SquareFile file;
    expectSquare(Read(folder, "a.glb", file.glb()));
    expectSquare(Read(folder, "a.gltf", file.embedded()));
    folder.write("a buffer.bin", file.buffer);
    expectSquare(Read(folder, "b.gltf", file.gltf("a%20buffer.bin")));
    EXPECT_EQ(filesBesideMesh(folder / "b.gltf"), (std::vector{folder / "a buffer.bin"}));
    EXPECT_TRUE(filesBesideMesh(folder / "a.glb").empty());
    // Most of a file may lie beside it.
    SquareFile large;
    std::vector<float> corners;
    for (int i = 0; i < 20000; ++i)
        for (const float x : {float(i), float(i % 3 == 1), float(i % 3 == 2)}) corners.push_back(x);
    large.add(packedBytes(corners), 5126, "VEC3", 20000);
    large.primitive() = {{"attributes", {{"POSITION", 4}}}};
    folder.write("large.bin", large.buffer);
    EXPECT_EQ(Read(folder, "c.gltf", large.gltf("large.bin")).mesh.vertexCount(), 20000u);
    // Told by content, whatever the ending says.
    expectSquare(Read(folder, "mesh.ply", file.glb()));
}

TEST(GltfReader, IndicesOfAllTypesAndNoneAreRead) {
    expectSquare(Read(SquareFile(packedBytes<uint8_t>({0, 1, 2, 0, 2, 3}), 5121)));
    expectSquare(Read(SquareFile(packedBytes<uint32_t>({0, 1, 2, 0, 2, 3}), 5125)));
    SquareFile strip(packedBytes<uint16_t>({1, 2, 0, 3, 0, 0}));
    strip.primitive()["mode"] = 5;
    EXPECT_EQ(Read(strip).mesh.triangles, (std::vector<Triangle>{{1, 2, 0}, {2, 3, 0}}));
    SquareFile fan(packedBytes<uint16_t>({0, 1, 2, 3, 0, 0}));
    fan.root["accessors"][3]["count"] = 4;
    fan.primitive()["mode"] = 6;
    EXPECT_EQ(Read(fan).mesh.triangles, (std::vector<Triangle>{{1, 2, 0}, {2, 3, 0}}));
    SquareFile none;
    none.primitive().erase("indices");
    EXPECT_EQ(Read(none).mesh.triangles, (std::vector<Triangle>{{0, 1, 2}}));
    EXPECT_EQ(refusalOf(SquareFile(packedBytes<float>({0, 1, 2, 0, 2, 3}), 5126)),
              "accessors[3].componentType: is 5126, expected 5121, 5123 or 5125 for indices");
}

TEST(GltfReader, QuantizedPositionsAndPlacesAreRead) {
    SquareFile file;
    file.root["extensionsRequired"] = {"KHR_mesh_quantization"};
    file.add(packedBytes<int16_t>({0, 0, 0, 0, 32767, 0, 0, 0, 32767, 32767, 0, 0, 0, 32767, 0, 0}), 5122, "VEC3", 4);
    file.root["bufferViews"][4]["byteStride"] = 8;
    file.root["accessors"][4]["normalized"] = true;
    file.add(packedBytes<uint8_t>({0, 255, 0, 0, 255, 255, 0, 0, 255, 0, 0, 0, 0, 0, 0, 0}), 5121, "VEC2", 4);
    file.root["bufferViews"][5]["byteStride"] = 4;
    file.root["accessors"][5]["normalized"] = true;
    file.primitive()["attributes"] = {{"POSITION", 4}, {"NORMAL", 1}, {"TEXCOORD_0", 5}};
    expectSquare(Read(file));
}

TEST(GltfReader, NodesPlaceTheirMeshes) {
    SquareFile file;
    const double half = std::sqrt(0.5);
    file.root["nodes"] = {{{"translation", {1, 0, 0}}, {"children", {1, 2}}},
                          {{"mesh", 0}, {"rotation", {0, 0, half, half}}, {"scale", {2, 1, 1}}},
                          {{"mesh", 0}, {"matrix", {-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 3, 1}}}};
    const Read read(file);
    ASSERT_EQ(read.mesh.vertexCount(), 8u);
    EXPECT_LT(glm::distance(read.mesh.positions[1], Vec3(1, 2, 0)), 1e-6f);  // stretched, then turned
    EXPECT_LT(glm::distance(read.mesh.positions[3], Vec3(0, 0, 0)), 1e-6f);
    EXPECT_LT(glm::distance(read.mesh.positions[5], Vec3(0, 0, 3)), 1e-6f);
    EXPECT_LT(glm::distance(read.mesh.normals[5], Vec3(0, 0, 1)), 1e-6f);
    for (size_t t = 0; t < 4; ++t) EXPECT_GT(read.mesh.faceNormal(t).z, 0.99f) << t;  // mirrored ones are turned round
    // What no scene names is not there; without scenes everything is.
    file.root["scenes"] = {{{"nodes", {2}}}};
    file.root["nodes"][0].erase("children");
    EXPECT_EQ(Read(file).mesh.vertexCount(), 4u);
    file.root.erase("scenes");
    EXPECT_EQ(Read(file).mesh.vertexCount(), 8u);
}

TEST(GltfReader, VerticesSplitByTextureAloneAreOne) {
    SquareFile file;
    // The second triangle has corners of its own, elsewhere in the image; a third one faces the other way.
    file.add(packedBytes<float>({0, 0, 0, 1, 1, 0, -0.0f, 1, 0}), 5126, "VEC3", 3);
    file.add(packedBytes<float>({0, 0, 1, 0, 0, 1, 0, 0, 1}), 5126, "VEC3", 3);
    file.add(packedBytes<float>({0.5f, 0, 0.6f, 0, 0.5f, 0.1f}), 5126, "VEC2", 3);
    file.add(packedBytes<float>({0, 0, -1, 0, 0, -1, 0, 0, -1}), 5126, "VEC3", 3);
    file.add(packedBytes<float>({0, 0, 0, 0, 1, 0, 1, 1, 0}), 5126, "VEC3", 3);
    file.root["accessors"][3]["count"] = 3;
    json& primitives = file.root["meshes"][0]["primitives"];
    primitives.push_back({{"attributes", {{"POSITION", 4}, {"NORMAL", 5}, {"TEXCOORD_0", 6}}}});
    primitives.push_back({{"attributes", {{"POSITION", 8}, {"NORMAL", 7}}}});
    const Read read(file);
    EXPECT_EQ(read.mesh.vertexCount(), 7u);
    EXPECT_EQ(read.mesh.triangles[1], (Triangle{0, 2, 3}));
    ASSERT_EQ(read.texcoords.size(), 2u);
    EXPECT_EQ(read.texcoords[1].corners, (Triangle{0, 2, 3}));
    EXPECT_EQ(read.texcoords[1].texcoords[0], Vec2(0.5f, 1));
    EXPECT_EQ(read.mesh.triangles.size(), 3u);
    EXPECT_LT(read.mesh.faceNormal(2).z, -0.99f);
}

TEST(GltfReader, WhatIsNotReadIsNamed) {
    SquareFile draco;
    draco.root["extensionsRequired"] = {"KHR_draco_mesh_compression"};
    EXPECT_EQ(refusalOf(draco),
              "extensionsRequired: names KHR_draco_mesh_compression, which relamp does not read; export the mesh "
              "without it");
    draco.root.erase("extensionsRequired");
    draco.primitive()["extensions"]["KHR_draco_mesh_compression"] = {{"bufferView", 0}};
    EXPECT_EQ(refusalOf(draco),
              "meshes[0].primitives[0].extensions.KHR_draco_mesh_compression: is not read; export the mesh without it");
    SquareFile old;
    old.root["asset"]["version"] = "1.0";
    EXPECT_EQ(refusalOf(old), "asset.version: is \"1.0\", expected 2.0");
    SquareFile skinned;
    skinned.root["nodes"][0]["skin"] = 0;
    EXPECT_EQ(refusalOf(skinned), "nodes[0].skin: skinned meshes are not read");
    SquareFile sparse;
    sparse.root["accessors"][0]["sparse"] = {{"count", 1}};
    EXPECT_EQ(refusalOf(sparse), "accessors[0].sparse: sparse accessors are not read");
    SquareFile points;
    points.primitive()["mode"] = 0;
    EXPECT_EQ(refusalOf(points), "holds 0 vertices and no faces, expected a surface of triangles");
    EXPECT_EQ(refusalOf(SquareFile().gltf("https://example.org/a.bin"), "a.gltf"),
              "buffers[0].uri: is \"https://example.org/a.bin\", expected data or the name of a file beside it");
    EXPECT_NE(refusalOf(SquareFile().gltf("none.bin"), "a.gltf").find("none.bin: does not exist"), std::string::npos);
    EXPECT_EQ(refusalOf(SquareFile().gltf("data:;base64,AA*A"), "a.gltf"),
              "buffers[0].uri: holds no base64 at character 2");
}

TEST(GltfReader, NodesThatAreNoTreeAreRefused) {
    SquareFile file;
    file.root["nodes"] = {{{"children", {1}}}, {{"children", {0}}, {"mesh", 0}}};
    EXPECT_EQ(refusalOf(file), "nodes[1].children: node 0 is reached twice, expected a tree");
    file.root["nodes"] = {{{"children", {0}}}};
    EXPECT_EQ(refusalOf(file), "nodes[0].children: node 0 is reached twice, expected a tree");
    file.root["nodes"] = {{{"children", {7}}}};
    EXPECT_EQ(refusalOf(file), "nodes[0].children: is 7, the file has 1 nodes");
    file.root["nodes"] = {{{"children", {-1}}}};
    EXPECT_EQ(refusalOf(file), "nodes[0].children[0]: expected a whole number");
    // A chain as deep as the file is long.
    file.root["nodes"] = json::array();
    for (int i = 1; i < 20000; ++i) file.root["nodes"].push_back({{"children", {i}}});
    file.root["nodes"].push_back({{"mesh", 0}});
    EXPECT_EQ(refusalOf(file), "");
}

TEST(GltfReader, ClaimsBeyondTheFileAreRefusedBeforeMemoryIsAskedFor) {
    const uint64_t huge = uint64_t(1) << 60;
    const auto with = [](const json::json_pointer& field, const json& value) {
        SquareFile file;
        file.root[field] = value;
        return refusalOf(file);
    };
    using namespace nlohmann::literals;
    EXPECT_NE(with("/accessors/0/count"_json_pointer, huge).find("accessors[0].count: is 1152921504606846976, exp"),
              std::string::npos);
    EXPECT_EQ(with("/accessors/0/count"_json_pointer, 5),
              "accessors[0].count: is 5 after byteOffset 0, the bufferView holds 48 bytes");
    EXPECT_NE(with("/accessors/3/count"_json_pointer, huge).find("accessors[3].count: is"), std::string::npos);
    EXPECT_NE(with("/accessors/0/byteOffset"_json_pointer, huge).find("accessors[0].count: is 4 after"),
              std::string::npos);
    EXPECT_NE(with("/bufferViews/0/byteLength"_json_pointer, huge).find("bufferViews[0].byteLength: is"),
              std::string::npos);
    EXPECT_NE(with("/bufferViews/0/byteOffset"_json_pointer, huge).find("bufferViews[0].byteLength: is"),
              std::string::npos);
    EXPECT_EQ(with("/bufferViews/0/byteStride"_json_pointer, 8),
              "accessors[0].type: reads 12 bytes an element, more than the byteStride 8 of its bufferView");
    EXPECT_EQ(with("/bufferViews/0/byteStride"_json_pointer, huge),
              "bufferViews[0].byteStride: is 1152921504606846976, expected 4 to 252");
    EXPECT_EQ(with("/accessors/0/componentType"_json_pointer, 5130),
              "accessors[0].componentType: is 5130, expected 5120, 5121, 5122, 5123, 5125 or 5126");
    EXPECT_EQ(with("/accessors/0/type"_json_pointer, "MAT4"), "accessors[0].type: is \"MAT4\", expected VEC3");
    EXPECT_EQ(with("/accessors/0/bufferView"_json_pointer, 9),
              "accessors[0].bufferView: is 9, the file has 4 bufferViews");
    EXPECT_EQ(with("/meshes/0/primitives/0/attributes/POSITION"_json_pointer, 9),
              "meshes[0].primitives[0].attributes.POSITION: is 9, the file has 4 accessors");
    EXPECT_EQ(with("/nodes/0/mesh"_json_pointer, 3), "nodes[0].mesh: is 3, the file has 1 meshes");
    EXPECT_EQ(with("/scene"_json_pointer, 3), "scene: is 3, the file has 1 scenes");
    EXPECT_EQ(with("/nodes/0/scale"_json_pointer, {1, 2}), "nodes[0].scale: expected 3 numbers");
    EXPECT_EQ(with("/nodes/0/rotation"_json_pointer, {0, 0, 0, 0}),
              "nodes[0].rotation: has no length, expected a unit quaternion");
    std::string glb = SquareFile().glb();
    std::memcpy(glb.data() + 12, "\xff\xff\xff\x7f", 4);
    EXPECT_NE(refusalOf(glb).find("chunk 0 claims 2147483647 bytes, the file holds"), std::string::npos);
    // A small file that stands for a large mesh.
    SquareFile many;
    many.root["nodes"] = json::array();
    many.root["scenes"][0]["nodes"] = json::array();
    for (int i = 0; i < 3000; ++i) {
        many.root["nodes"].push_back({{"mesh", 0}});
        many.root["scenes"][0]["nodes"].push_back(i);
    }
    json primitives = json::array();
    for (int i = 0; i < 200; ++i) primitives.push_back(many.primitive());
    many.root["meshes"][0]["primitives"] = primitives;
    EXPECT_NE(refusalOf(many).find("its meshes are placed so often that they have more than"), std::string::npos);
    // The same of its texture alone.
    many.root["meshes"][0]["primitives"] = json::array();
    many.primitive() = SquareFile().primitive();
    many.add(std::string(64000, 0), 5121, "VEC2", 32000);
    many.primitive()["attributes"]["TEXCOORD_0"] = 4;
    EXPECT_NE(refusalOf(many).find("its meshes are placed so often"), std::string::npos);
    EXPECT_EQ(refusalOf(SquareFile().glb(), "a.glb", {3, 100}), "accessors[0].count: is 4, expected at most 3");
}

TEST(GltfReader, TruncationsAreRefusedAndChangedBytesAreReadOrRefused) {
    const std::string whole = SquareFile().glb();
    for (size_t length = 0; length < whole.size(); length += 3 + length % 5)
        EXPECT_FALSE(refusalOf(whole.substr(0, length)).empty()) << "cut to " << length;
    for (size_t at = 0; at < whole.size(); at += 5 + at % 7)
        for (const char c : {'\0', '\xff', '9', '-'}) {
            std::string bytes = whole;
            bytes[at] = c;
            refusalOf(bytes);
        }
}

}  // namespace
}  // namespace relamp
