// OpenMesh's own files: what its library writes is read, what would lead it astray is refused before it sees it.
#include <gtest/gtest.h>

#include "base/error.h"
#include "scene/mesh_io.h"
#include "support/temporary_folder.h"

namespace relamp {
namespace {

using test::TemporaryFolder;

std::string bytesOf(const std::string& hex) {
    std::string bytes;
    for (size_t i = 0; i < hex.size(); i += 2) bytes.push_back(char(std::stoi(hex.substr(i, 2), nullptr, 16)));
    return bytes;
}

/// A square of one face with four corners, as OpenMesh 11 writes it: positions, half-edges (next, vertex, face),
/// vertices, faces.
const std::string squareFile = bytesOf(
    "4f4d504204000000010000000400000000160000000000000000000000000000803f0000000000000000000000000000803f00000000000000"
    "00000000000000803f"
    "f8160201000700ff0403000101ff0602000303ff0000000502ff"
    "e00607010503e806061c00");

std::string errorOf(const std::string& bytes) {
    const TemporaryFolder folder;
    const std::string file = folder.write("a.om", bytes).string();
    const std::string message = test::messageOf([&] { readMesh(file); });
    return message.rfind(file + ": ", 0) == 0 ? message.substr(file.size() + 2) : message;
}

std::string with(size_t at, char value) {
    std::string bytes = squareFile;
    bytes.at(at) = value;
    return bytes;
}

TEST(OpenMeshFile, AFaceOfFourCornersIsTwoTriangles) {
    const TemporaryFolder folder;
    const Mesh mesh = readMesh(folder.write("a.om", squareFile));
    EXPECT_EQ(mesh.vertexCount(), 4u);
    EXPECT_EQ(mesh.triangles.size(), 2u);
    EXPECT_EQ(mesh.positions[1], Vec3(1, 0, 0));
}

TEST(OpenMeshFile, TheFuzzingCorpusHoldsFilesOfEveryVersion) {
    const std::filesystem::path corpus = RELAMP_SOURCE_DIR "/tests/fuzz/corpus/mesh-om";
    EXPECT_EQ(readMesh(corpus / "corners.om").triangles.size(), 2u);    // 1.2: faces by their corners
    EXPECT_EQ(readMesh(corpus / "triangles.om").triangles.size(), 4u);  // 2.2
    EXPECT_EQ(readMesh(corpus / "properties.om").triangles.size(),
              4u);  // with normals, colours, states and custom properties
}

TEST(OpenMeshFile, WhatDoesNotFitTogetherIsRefused) {
    constexpr size_t halfEdges = 16 + 2 + 48 + 2, faces = halfEdges + 24 + 2 + 4 + 2;
    ASSERT_EQ(squareFile.size(), faces + 1 + 2);
    EXPECT_EQ(errorOf(with(halfEdges, 8)), "half-edge 0 names what is not there");
    EXPECT_EQ(errorOf(with(halfEdges + 1, 4)), "half-edge 0 names what is not there");
    EXPECT_EQ(errorOf(with(halfEdges + 2, 1)), "half-edge 0 names what is not there");
    EXPECT_EQ(errorOf(with(halfEdges + 6, 2)),
              "the edges of face 0 are not closed");  // a ring that never comes back to where it began
    EXPECT_EQ(errorOf(with(halfEdges + 24 + 2, 9)), "a vertex names half-edge 9 of 8");
    EXPECT_EQ(errorOf(with(faces, 8)), "face 0 names half-edge 8 of 8");
    EXPECT_EQ(errorOf(with(faces, 1)), "the edges of face 0 are not closed");
    EXPECT_EQ(errorOf(with(17, 6)), "has positions that are not three 32-bit floats");
    EXPECT_EQ(errorOf(with(7, 1)), "claims 16777220 vertices, 1 faces and 4 edges, more than the file holds");
    EXPECT_EQ(errorOf(with(3, 0x60)), "is of version 3.0, expected at most 2.2");
    EXPECT_EQ(errorOf(with(2, 'X')), "is of a kind that is not known, expected T, Q or P");
    for (size_t kept = 1; kept < faces + 1; ++kept) EXPECT_NE(errorOf(squareFile.substr(0, kept)), "") << kept;
    for (size_t at = 0; at < squareFile.size(); ++at)
        for (const char value : {'\0', '\x01', '\x7f', '\xff'}) errorOf(with(at, value));
}

}  // namespace
}  // namespace relamp
