#include "scene/mesh_io.h"

#include <gtest/gtest.h>

#include <bit>

#include <cstring>
#include <limits>

#include "base/error.h"
#include "scene/texcoords.h"
#include "support/temporary_folder.h"

namespace relamp {
namespace {

template <class T>
void put(std::string& bytes, T value, bool bigEndian = false) {
    char raw[sizeof(T)];
    std::memcpy(raw, &value, sizeof raw);
    if (bigEndian) std::reverse(raw, raw + sizeof raw);
    bytes.append(raw, sizeof raw);
}

constexpr float nan = std::numeric_limits<float>::quiet_NaN();
constexpr float square[4][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};

std::string plyHeader(const std::string& format, const std::string& vertices = "4", const std::string& faces = "1") {
    return "ply\nformat " + format + " 1.0\ncomment by hand\nelement vertex " + vertices +
           "\nproperty float x\nproperty float y\nproperty float z\nelement face " + faces +
           "\nproperty list uchar int vertex_indices\nend_header\n";
}

std::string asciiPly(const std::string& vertices, const std::string& faces, const std::string& part) {
    return plyHeader("ascii", vertices, faces) + part;
}

/// A mesh from the text of vertices and faces, in a file of its own.
Mesh fromAscii(const std::string& vertices, const std::string& faces, const std::string& part,
               MeshReport* report = nullptr) {
    test::TemporaryFolder folder;
    return readMesh(folder.write("mesh.ply", asciiPly(vertices, faces, part)), report);
}

std::string errorFor(const std::string& name, const std::string& bytes, const MeshLimits& limits = {}) {
    static const test::TemporaryFolder folder;
    const auto file = folder.write(name, bytes);
    std::string message = test::messageOf([&] { readMesh(file, nullptr, limits); });
    if (message.rfind(file.string() + ": ", 0) == 0) message.erase(0, file.string().size() + 2);
    return message;
}

void expectSquare(const Mesh& mesh, const MeshReport& report) {
    ASSERT_EQ(mesh.vertexCount(), 4u);
    ASSERT_EQ(mesh.triangles.size(), 2u);
    EXPECT_EQ(mesh.positions[2], Vec3(1, 1, 0));
    EXPECT_EQ(mesh.triangles[0], (Triangle{0, 1, 2}));
    EXPECT_EQ(mesh.triangles[1], (Triangle{0, 2, 3}));
    EXPECT_NEAR(glm::distance(mesh.normals[3], Vec3(0, 0, 1)), 0, 1e-6);
    EXPECT_EQ(report.polygons, 1u);
    EXPECT_EQ(report.boundaryEdges, 4u);
    EXPECT_EQ(report.nonManifoldEdges, 0u);
    EXPECT_EQ(report.triangles, 2u);
}

TEST(MeshIo, BinaryPlyOfEitherByteOrderIsRead) {
    test::TemporaryFolder folder;
    for (const bool big : {false, true}) {
        std::string bytes = plyHeader(big ? "binary_big_endian" : "binary_little_endian");
        for (const auto& v : square)
            for (const float c : v) put(bytes, c, big);
        bytes.push_back(4);
        for (int32_t i = 0; i < 4; ++i) put(bytes, i, big);
        MeshReport report;
        const Mesh mesh = readMesh(folder.write("mesh.ply", bytes), &report);
        expectSquare(mesh, report);
        EXPECT_FALSE(report.normalsFromFile);
        const auto cut = folder.write("cut.ply", bytes.substr(0, bytes.size() - 3));
        EXPECT_EQ(test::messageOf([&] { readMesh(cut); }), cut.string() + ": ends before its last element");
    }
}

TEST(MeshIo, PlyWithUnknownElementsAndPropertiesIsRead) {
    std::string bytes =
        "ply\r\nformat binary_little_endian 1.0\r\nobj_info scanner\r\nelement camera 2\r\nproperty list int double "
        "pose\r\n"
        "property uchar flag\r\nelement vertex 4\r\nproperty list uchar short neighbours\r\nproperty double "
        "z\r\nproperty uchar red\r\n"
        "property double y\r\nproperty float x\r\nelement face 1\r\nproperty float quality\r\nproperty list uint "
        "ushort vertex_index\r\n"
        "element edge 1\r\nproperty int a\r\nend_header\r\n";
    for (const int32_t count : {2, 0}) {
        put(bytes, count);
        for (int i = 0; i < count; ++i) put(bytes, 1.5);
        put(bytes, uint8_t(7));
    }
    for (const auto& v : square) {
        put(bytes, uint8_t(2));
        put(bytes, int16_t(1));
        put(bytes, int16_t(2));
        put(bytes, double(v[2]));
        put(bytes, uint8_t(200));
        put(bytes, double(v[1]));
        put(bytes, v[0]);
    }
    put(bytes, 0.5f);
    put(bytes, uint32_t(4));
    for (uint16_t i = 0; i < 4; ++i) put(bytes, i);
    put(bytes, int32_t(3));
    test::TemporaryFolder folder;
    MeshReport report;
    const Mesh mesh = readMesh(folder.write("mesh.ply", bytes), &report);
    expectSquare(mesh, report);
}

TEST(MeshIo, BinaryOffIsReadInEitherByteOrderWithAndWithoutFaceColours) {
    const test::TemporaryFolder folder;
    for (const bool swapped : {false, true})
        for (const int colours : {-1, 0, 3}) {
            std::string bytes = "OFF BINARY\n";
            const auto word = [&](uint32_t value) {
                if (swapped) value = __builtin_bswap32(value);
                bytes.append(reinterpret_cast<const char*>(&value), 4);
            };
            const auto number = [&](float value) { word(std::bit_cast<uint32_t>(value)); };
            for (const uint32_t count : {4u, 1u, 0u}) word(count);
            for (const float x : {0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 1.f, 1.f, 0.f, 0.f, 1.f, 0.f}) number(x);
            for (const uint32_t corner : {4u, 0u, 1u, 2u, 3u}) word(corner);
            if (colours >= 0) word(uint32_t(colours));
            for (int c = 0; c < colours; ++c) number(0.5f);
            MeshReport report;
            expectSquare(readMesh(folder.write("a.off", bytes), &report), report);
            EXPECT_NE(test::messageOf([&] { readMesh(folder.write("a.off", bytes + "xxxx")); }), "");
        }
}

TEST(MeshIo, AsciiPlyObjAndOffAreRead) {
    test::TemporaryFolder folder;
    MeshReport report;
    expectSquare(fromAscii("4", "1", "0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3", &report), report);
    const Mesh obj = readMesh(
        folder.write("a.obj",
                     "# a square\r\nmtllib x.mtl\r\nv 0 0 0\r\nv 1 0 0 1\r\nv +1 1 0 0.5 0.5 0.5\r\nv 0 1 0\r\n"
                     "vt 0 0\r\ng one\r\nf 1/1 2/1 \\\r\n3/1 -1/1\r\n"),
        &report);
    expectSquare(obj, report);
    const Mesh off = readMesh(
        folder.write("a.off", "# comment\nOFF\n4 1 0\n0 0 0\n1 0 0 # here\n\n1 1 0\n0 1 0\n4 0 1 2 3 255 0 0\n"),
        &report);
    expectSquare(off, report);
    const Mesh coff = readMesh(
        folder.write("b.off", "COFF 4 1 0\n0 0 0 9 9 9\n1 0 0 9 9 9\n1 1 0 9 9 9\n0 1 0 9 9 9\n4 0 1 2 3\n"), &report);
    expectSquare(coff, report);
}

TEST(MeshIo, StlVerticesAtEqualPositionsBecomeOne) {
    test::TemporaryFolder folder;
    const int corners[2][3] = {{0, 1, 2}, {0, 2, 3}};
    std::string binary(80, 's');
    binary.replace(0, 5, "solid");  // some binary files begin like ascii ones
    put(binary, uint32_t(2));
    std::string ascii = "solid vertex facet\n";
    for (const auto& triangle : corners) {
        for (int i = 0; i < 3; ++i) put(binary, 0.0f);
        ascii += "facet normal 0 0 1\nouter loop\n";
        for (const int c : triangle) {
            for (const float x : square[c]) put(binary, x == 0 && c == 2 ? -0.0f : x);
            ascii += fmt::format("vertex {} {} {}\n", square[c][0], square[c][1], square[c][2]);
        }
        put(binary, uint16_t(0));
        ascii += "endloop\nendfacet\n";
    }
    ascii += "endsolid\n";
    for (const auto& bytes : {binary, ascii}) {
        MeshReport report;
        const Mesh mesh = readMesh(folder.write("mesh.stl", bytes), &report);
        EXPECT_EQ(mesh.vertexCount(), 4u);
        EXPECT_EQ(mesh.triangles.size(), 2u);
        EXPECT_EQ(report.boundaryEdges, 4u);
    }
    EXPECT_EQ(errorFor("cut.stl", ascii.substr(0, ascii.size() / 2)), "ends inside a facet");
    std::string noSolid = binary;
    noSolid[0] = 'x';
    EXPECT_EQ(errorFor("cut.stl", noSolid.substr(0, noSolid.size() - 1)), "claims 2 triangles, the file holds 1");
    EXPECT_EQ(errorFor("short.stl", "xyz"), "has 3 bytes, too few for an STL file");
}

TEST(MeshIo, NonManifoldEdgesAndHolesAreKeptAndCounted) {
    MeshReport report;
    const Mesh mesh = fromAscii("5", "3", "0 0 0\n1 0 0\n0 1 0\n0 -1 0\n0 0 1\n3 0 1 2\n3 0 1 3\n3 0 1 4\n", &report);
    EXPECT_EQ(mesh.triangles.size(), 3u);
    EXPECT_EQ(report.nonManifoldEdges, 1u);
    EXPECT_EQ(report.boundaryEdges, 6u);
}

TEST(MeshIo, SeamsAreNoHoles) {
    MeshReport report;
    fromAscii("6", "2", "0 0 0\n1 0 0\n1 1 0\n0 0 0\n1 1 0\n0 1 0\n3 0 1 2\n3 3 4 5\n", &report);
    EXPECT_EQ(report.boundaryEdges, 4u);
}

TEST(MeshIo, VerticesThatAreNotFiniteLoseTheirFacesAndKeepTheirPlace) {
    MeshReport report;
    const Mesh mesh = fromAscii(
        "6", "4", "0 0 0\nnan 0 0\n1 0 0\n0 1 0\n0 inf 0\n1e30 0 0\n3 0 1 2\n3 0 2 3\n3 0 2 4\n3 0 3 5\n", &report);
    EXPECT_EQ(report.nanVertices, 3u);
    EXPECT_EQ(mesh.vertexCount(), 6u);
    ASSERT_EQ(mesh.triangles.size(), 1u);
    EXPECT_EQ(mesh.triangles[0], (Triangle{0, 2, 3}));
    EXPECT_EQ(report.unreferencedVertices, 3u);
    for (const Vec3& p : mesh.positions) EXPECT_TRUE(isFinite(p) && glm::length(p) < 2);
    for (const Vec3& n : mesh.normals) EXPECT_NEAR(glm::length(n), 1, 1e-5);
}

TEST(MeshIo, FacesWithoutAreaAndRepeatedFacesAreDroppedAndCounted) {
    MeshReport report;
    const Mesh mesh = fromAscii(
        "4", "6", "0 0 0\n1 0 0\n2 0 0\n0 1 0\n3 0 1 3\n3 0 1 2\n3 0 0 1\n3 1 3 0\n3 3 1 0\n2 0 1\n", &report);
    EXPECT_EQ(mesh.triangles.size(), 1u);
    EXPECT_EQ(report.degenerateFaces, 2u);
    EXPECT_EQ(report.duplicateFaces, 2u);
    EXPECT_EQ(report.badIndexFaces, 1u);
}

TEST(MeshIo, OfFacesInOnePlaceThatAreTurnedAlikeOneStays) {
    // Three copies turned one way, two the other, each with corners of its own, and a face beside them.
    std::string points, faces;
    for (int copy = 0; copy < 5; ++copy) {
        points += "0 0 0\n1 0 0\n0 1 0\n";
        faces += copy % 2 ? fmt::format("3 {} {} {}\n", 3 * copy, 3 * copy + 2, 3 * copy + 1)
                          : fmt::format("3 {} {} {}\n", 3 * copy + 1, 3 * copy + 2, 3 * copy);
    }
    MeshReport report;
    const Mesh mesh = fromAscii("18", "6", points + "0 0 1\n1 0 1\n0 1 1\n" + faces + "3 15 16 17\n", &report);
    ASSERT_EQ(mesh.triangles.size(), 3u);
    EXPECT_EQ(report.duplicateFaces, 3u);
    EXPECT_GT(glm::dot(mesh.faceNormal(0), Vec3(0, 0, 1)), 0.9f);
    EXPECT_LT(glm::dot(mesh.faceNormal(1), Vec3(0, 0, 1)), -0.9f);
}

TEST(MeshIo, FacesThatNameNoVertexAreDroppedAndCounted) {
    MeshReport report;
    const Mesh mesh =
        fromAscii("3", "4", "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n3 0 1 3\n3 0 -1 2\n3 0 1 4000000000\n", &report);
    EXPECT_EQ(mesh.triangles.size(), 1u);
    EXPECT_EQ(report.badIndexFaces, 3u);
    test::TemporaryFolder folder;
    readMesh(
        folder.write(
            "a.obj",
            "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 0 1 2\nf 1 2 9\nf -4 1 2\nf 1 2 99999999999999999999\nf a b c\n"),
        &report);
    EXPECT_EQ(report.triangles, 1u);
    EXPECT_EQ(report.badIndexFaces, 5u);
}

TEST(MeshIo, MeshesWithoutASurfaceAreRefused) {
    EXPECT_EQ(errorFor("a.ply", asciiPly("2", "0", "0 0 0\n1 1 1\n")),
              "holds 2 vertices and no faces, expected a surface of triangles");
    EXPECT_NE(errorFor("a.ply", asciiPly("3", "1", "0 0 0\n1 0 0\n2 0 0\n3 0 1 2\n"))
                  .find("holds no usable triangle: of 1 faces 0 touch"),
              std::string::npos);
    EXPECT_NE(errorFor("a.ply", asciiPly("3", "1", "nan 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"))
                  .find("1 touch a vertex that is not finite"),
              std::string::npos);
    EXPECT_EQ(errorFor("a.obj", "v 0 0 0\n"), "holds 1 vertices and no faces, expected a surface of triangles");
}

TEST(MeshIo, CountsBeyondTheFileAreRefusedBeforeMemoryIsAskedFor) {
    const std::string huge = "1152921504606846976";  // 2^60
    for (const char* format : {"ascii", "binary_little_endian", "binary_big_endian"}) {
        EXPECT_NE(errorFor("a.ply", plyHeader(format, huge, "1") + "0 0 0\n").find("element vertex claims " + huge),
                  std::string::npos);
        EXPECT_NE(
            errorFor("a.ply", plyHeader(format, "1", huge) + "0 0 0\n0 0 0\n").find("element face claims " + huge),
            std::string::npos);
        EXPECT_EQ(errorFor("a.ply", plyHeader(format, "-1", "1")),
                  "header: element vertex has count \"-1\", expected 0 or more");
        EXPECT_EQ(errorFor("a.ply", plyHeader(format, "many", "1")),
                  "header: element vertex has count \"many\", expected 0 or more");
        EXPECT_NE(errorFor("a.ply", plyHeader(format, "99999999999999999999999", "1")), "");
    }
    EXPECT_NE(errorFor("a.off", "OFF\n" + huge + " 1 0\n0 0 0\n").find("claims " + huge), std::string::npos);
    EXPECT_NE(errorFor("a.off", "OFF\n1 " + huge + " 0\n0 0 0\n").find("more than the file holds"), std::string::npos);
    EXPECT_EQ(errorFor("a.off", "OFF\n-1 1 0\n"), "has \"-1\" for its number of vertices, expected 0 or more");
    std::string stl(80, 'x');
    put(stl, uint32_t(0xffffffff));
    EXPECT_EQ(errorFor("a.stl", stl + "rest"), "claims 4294967295 triangles, the file holds 0");
    // A list inside the part can lie as well.
    std::string list =
        "ply\nformat binary_little_endian 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n"
        "element face 1\nproperty list uint int vertex_indices\nend_header\n";
    for (int i = 0; i < 3; ++i) put(list, 0.0f);
    put(list, uint32_t(0xfffffff0));
    EXPECT_NE(errorFor("a.ply", list).find("list vertex_indices claims"), std::string::npos);
    EXPECT_NE(errorFor("a.ply", asciiPly("1", "1", "0 0 0\n-3 0\n")).find("list vertex_indices has length -3"),
              std::string::npos);
    EXPECT_NE(errorFor("a.off", "OFF\n1 1 0\n0 0 0\n1000000000 1\n").find("face 0 has no proper number"),
              std::string::npos);
    std::string binaryOff = "OFF BINARY\n";
    put(binaryOff, uint32_t(0xf0000000));
    put(binaryOff, uint32_t(1));
    put(binaryOff, uint32_t(0));
    EXPECT_NE(errorFor("a.off", binaryOff).find("more than the file holds"), std::string::npos);
}

TEST(MeshIo, TexturePlacesOfObjAndPlyFollowTheirCorners) {
    const test::TemporaryFolder folder;
    const FaceTexcoords first{Vec2(0, 0), Vec2(1, 0), Vec2(1, 0.5f)}, second{Vec2(0, 0), Vec2(1, 0.5f), Vec2(0, 0.5f)};
    const auto expectPlaces = [&](const std::string& name, const std::string& bytes) {
        std::vector<TexturedFace> faces;
        readMesh(folder.write(name, bytes), nullptr, {}, &faces);
        ASSERT_EQ(faces.size(), 2u) << bytes;
        EXPECT_EQ(faces[0].corners, (Triangle{0, 1, 2}));
        EXPECT_EQ(faces[0].texcoords, first) << bytes;
        EXPECT_EQ(faces[1].corners, (Triangle{0, 2, 3}));
        EXPECT_EQ(faces[1].texcoords, second) << bytes;
    };
    const std::string v = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n", vt = "vt 0 0.5\nvt 0\nvt 1 0 0\nvt 1 0.5\n";
    expectPlaces("a.obj", v + vt + "f 1/2 2/3 3/4 4/1\n");
    expectPlaces("a.obj", v + vt + "vn 0 0 1\nf 1/2/1 2/3/1 3/-1/1 4/-4/1\n");
    expectPlaces("a.obj", "f 1/2 2/3 3/4 4/1\n" + v + vt);
    const std::string face = "element face 1\nproperty list uchar int vertex_indices\n",
                      vertices = "property float x\nproperty float y\nproperty float z\n";
    for (const auto& [u, t] : {std::pair{"s", "t"}, std::pair{"u", "v"}, std::pair{"texture_u", "texture_v"}})
        expectPlaces("a.ply", fmt::format("ply\nformat ascii 1.0\nelement vertex 4\nproperty float {}\n{}property "
                                          "float {}\n{}end_header\n0 0 0 0 0\n1 1 0 0 0\n1 1 1 0 0.5\n0 0 1 0 "
                                          "0.5\n4 0 1 2 3\n",
                                          u, vertices, t, face));
    expectPlaces("a.ply", "ply\nformat ascii 1.0\nelement vertex 4\n" + vertices + face +
                              "property int texnumber\nproperty list uchar float texcoord\nend_header\n"
                              "0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3 0 8 0 0 1 0 1 0.5 0 0.5\n");
    // Corners without a place, or with one that is not there, leave their face without.
    std::vector<TexturedFace> faces;
    for (const char* f : {"f 1/2 2/3 3\n", "f 1/2 2/3 3/9\n", "f 1 2 3\n", "f 1//1 2//1 3//1\n"}) {
        readMesh(folder.write("a.obj", v + vt + f), nullptr, {}, &faces);
        EXPECT_TRUE(faces.empty()) << f;
    }
    EXPECT_EQ(errorFor("a.obj", v + "vt red\n"), "line 5: vt holds \"red\" where a number was expected");
}

TEST(MeshIo, TexturePlacesAreFoundByTheVerticesOfATriangle) {
    const std::vector<TexturedFace> faces{{{4, 1, 2}, {Vec2(0.4f), Vec2(0.1f), Vec2(0.2f)}},
                                          {{2, 4, 1}, {Vec2(1), Vec2(1), Vec2(1)}},
                                          {{0, 1, 2}, {Vec2(0.5f), Vec2(0.6f), Vec2(0.7f)}}};
    const std::vector<FaceTexcoords> found = texcoordsOf(faces, {{1, 2, 4}, {1, 2, 5}, {2, 1, 0}});
    EXPECT_EQ(found[0], (FaceTexcoords{Vec2(0.1f), Vec2(0.2f), Vec2(0.4f)}));
    EXPECT_EQ(found[1], FaceTexcoords{});
    EXPECT_EQ(found[2], (FaceTexcoords{Vec2(0.7f), Vec2(0.6f), Vec2(0.5f)}));
}

TEST(MeshIo, LimitsAreKept) {
    const std::string file = asciiPly("4", "1", "0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n");
    EXPECT_EQ(errorFor("a.ply", file, {3, 100}), "element vertex has 4 entries, expected at most 3");
    EXPECT_EQ(errorFor("a.ply", file, {4, 1}), "has more than 1 triangles");
    EXPECT_EQ(errorFor("a.obj", "v 0 0 0\nv 1 0 0\n", {1, 1}), "has more than 1 vertices");
}

TEST(MeshIo, EveryTruncationIsAnErrorOrASmallerMeshButNeverACrash) {
    std::string binary = plyHeader("binary_little_endian");
    for (const auto& v : square)
        for (const float c : v) put(binary, c);
    binary.push_back(4);
    for (int32_t i = 0; i < 4; ++i) put(binary, i);
    const std::string files[][2] = {{"a.ply", binary},
                                    {"a.ply", asciiPly("4", "1", "0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n")},
                                    {"a.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nvn 0 0 1\nf 1//1 2//1 3//1\n"},
                                    {"a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n1 1 0\n3 0 1 2\n"}};
    for (const auto& file : files)
        for (size_t length = 0; length + 4 < file[1].size(); ++length) {
            const std::string message = errorFor(file[0], file[1].substr(0, length));
            EXPECT_FALSE(message.empty()) << file[0] << " cut to " << length;
        }
    // Every single byte changed: read or refused, nothing else.
    for (const auto& file : files)
        for (size_t at = 0; at < file[1].size(); ++at)
            for (const char c : {'\0', '\xff', '9', '-'}) {
                std::string bytes = file[1];
                bytes[at] = c;
                errorFor(file[0], bytes);
            }
}

TEST(MeshIo, FilesThatAreNoMeshAreNamed) {
    test::TemporaryFolder folder;
    EXPECT_EQ(test::messageOf([&] { readMesh(folder / "none.ply"); }),
              (folder / "none.ply").string() + ": does not exist");
    EXPECT_EQ(errorFor("a.ply", ""), "is empty");
    EXPECT_EQ(errorFor("a.ply", "hello"), "is no PLY file");
    EXPECT_EQ(errorFor("a.txt", "hello"), "is no mesh relamp reads, expected PLY, OBJ, glTF, STL, OFF or OM");
    EXPECT_EQ(errorFor("a.ply", "ply\nformat ascii 1.0\n"), "header: ends without end_header");
    EXPECT_EQ(errorFor("a.ply", "ply\nformat ebcdic 1.0\n"), "header: format \"ebcdic\" is unknown");
    EXPECT_EQ(errorFor("a.ply", "ply\nformat ascii 1.0\nend_header\n"), "has no element vertex");
    EXPECT_EQ(errorFor("a.ply", "ply\nformat ascii 1.0\nelement vertex 0\nproperty quaternion x\nend_header\n"),
              "header: property type \"quaternion\" is unknown");
    EXPECT_EQ(errorFor("a.ply", asciiPly("1", "0", "0 zero 0\n")), "holds \"zero\" where a number was expected");
    EXPECT_EQ(errorFor("a.obj", "v 0 zero 0\n"), "line 1: v holds \"zero\" where a number was expected");
}

TEST(MeshIo, NormalsOfTheFileAreUsedWhereTheyAreFinite) {
    std::string bytes =
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nproperty float "
        "nx\n"
        "property float ny\nproperty float nz\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
        "0 0 0 2 0 0\n1 0 0 nan 0 0\n0 1 0 0 3 0\n3 0 1 2\n";
    test::TemporaryFolder folder;
    MeshReport report;
    const Mesh mesh = readMesh(folder.write("a.ply", bytes), &report);
    EXPECT_TRUE(report.normalsFromFile);
    EXPECT_EQ(mesh.normals[0], Vec3(1, 0, 0));
    EXPECT_EQ(mesh.normals[1], Vec3(0, 0, 1));
    EXPECT_EQ(mesh.normals[2], Vec3(0, 1, 0));
    const Mesh obj =
        readMesh(folder.write("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 -1 0\nf 1//1 2//1 3//1\n"), &report);
    EXPECT_TRUE(report.normalsFromFile);
    EXPECT_EQ(obj.normals[1], Vec3(0, -1, 0));
}

TEST(MeshIo, FacesTurnedAgainstTheFilesNormalsAreTurnedRound) {
    test::TemporaryFolder folder;
    const Mesh mesh = readMesh(
        folder.write("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nvn 0 0 1\nf 1//1 2//1 3//1\nf 2//1 3//1 4//1\n"));
    ASSERT_EQ(mesh.triangles.size(), 2u);
    for (size_t t = 0; t < 2; ++t) EXPECT_EQ(mesh.faceNormal(t), Vec3(0, 0, 1));
    // Without normals in the file the winding is all there is.
    const Mesh bare = readMesh(folder.write("b.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nf 1 2 3\nf 2 3 4\n"));
    EXPECT_EQ(bare.faceNormal(1), Vec3(0, 0, -1));
}

TEST(VertexPly, PropertiesComeBackByNameAndTheMeshAsItWas) {
    test::TemporaryFolder folder;
    const Mesh mesh = fromAscii("4", "1", "0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n");
    writeVertexPly(folder / "r.ply", mesh, {{"albedo_r", {0.1f, 0.2f, 0.3f, nan}}, {"emitter", {-1, 0, 1, 2}, true}});
    const auto properties = readVertexPly(folder / "r.ply");
    ASSERT_EQ(properties.size(), 8u);
    EXPECT_EQ(properties[0].name, "x");
    EXPECT_EQ(properties[6].name, "albedo_r");
    EXPECT_EQ(properties[6].values[2], 0.3f);
    EXPECT_TRUE(std::isnan(properties[6].values[3]));
    EXPECT_EQ(properties[7].name, "emitter");
    EXPECT_TRUE(properties[7].asInt);
    EXPECT_EQ(properties[7].values, (std::vector<float>{-1, 0, 1, 2}));
    const Mesh back = readMesh(folder / "r.ply");
    EXPECT_EQ(back.positions, mesh.positions);
    EXPECT_EQ(back.triangles, mesh.triangles);
}

TEST(VertexPly, BadInputIsNamedAndTheOldFileStays) {
    test::TemporaryFolder folder;
    const Mesh mesh = fromAscii("3", "1", "0 0 0\n1 0 0\n1 1 0\n3 0 1 2\n");
    const auto file = folder.write("r.ply", "as it was");
    EXPECT_EQ(test::messageOf([&] {
                  writeVertexPly(file, mesh, {{"albedo_r", {1}}});
              }),
              file.string() + ": property albedo_r has 1 values for 3 vertices");
    EXPECT_NE(test::messageOf([&] {
                  writeVertexPly(file, mesh, {{"two words", {1, 2, 3}}});
              }).find("no name of one word"),
              std::string::npos);
    EXPECT_EQ(test::TemporaryFolder::read(file), "as it was");
    EXPECT_THROW(writeVertexPly(folder / "no/folder/r.ply", mesh, {}), Error);
    EXPECT_EQ(test::messageOf([&] { readVertexPly(file); }), file.string() + ": is no PLY file");
    folder.write("r.ply", plyHeader("binary_little_endian", "1152921504606846976"));
    EXPECT_NE(test::messageOf([&] { readVertexPly(file); }).find("element vertex claims 1152921504606846976"),
              std::string::npos);
    folder.write("r.ply", "ply\nformat ascii 1.0\nelement face 0\nend_header\n");
    EXPECT_EQ(test::messageOf([&] { readVertexPly(file); }), file.string() + ": has no element vertex");
}

}  // namespace
}  // namespace relamp
