#include "scene/rim.h"

#include <gtest/gtest.h>

#include <numeric>

namespace relamp {
namespace {

TEST(Rim, OfASheetIsItsOutlineAndSeamsAreNone) {
    // Four by four vertices; the right half has vertices of its own along the middle.
    Mesh mesh;
    for (int half = 0; half < 2; ++half)
        for (int y = 0; y < 3; ++y)
            for (int x = 0; x < 2; ++x) mesh.positions.push_back({float(x + half), float(y), 0});
    for (uint32_t half = 0; half < 2; ++half)
        for (uint32_t y = 0; y < 2; ++y) {
            const uint32_t a = half * 6 + y * 2;
            mesh.triangles.push_back({a, a + 1, a + 3});
            mesh.triangles.push_back({a, a + 3, a + 2});
        }
    const std::vector<uint8_t> rim = rimVertices(mesh);
    EXPECT_EQ(std::accumulate(rim.begin(), rim.end(), 0), 10);
    EXPECT_FALSE(rim[3]);  // the middle, on either side of the seam
    EXPECT_FALSE(rim[8]);
}

TEST(Rim, AClosedPartHasNone) {
    Mesh mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}};
    for (const uint8_t r : rimVertices(mesh)) EXPECT_FALSE(r);
}

}  // namespace
}  // namespace relamp
