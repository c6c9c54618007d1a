#include "display/vertex_images.h"

#include <gtest/gtest.h>

#include "support/estimates.h"

namespace relamp {
namespace {

/// Three vertices: seen twice, seen once, never.
RadianceSamples threeVertices() {
    RadianceSamples s;
    s.start = {0, 2, 3, 3};
    s.samples = {{0, Rgb(1), 1, false}, {1, Rgb(4), 0.5f, false}, {1, Rgb(0.5f), 1, false}};
    s.noiseFloor = 1e-4f;
    return s;
}

TEST(VertexImages, photographColoursAreWeightedMeans) {
    const std::vector<Rgb> all = photographColours(threeVertices()), first = photographColours(threeVertices(), 0);
    EXPECT_FLOAT_EQ(all[0].x, 2);
    EXPECT_FLOAT_EQ(all[1].y, 0.5f);
    EXPECT_FLOAT_EQ(first[0].x, 1);
    EXPECT_LT(first[1].x, 0.1f);  // not seen by view 0
    EXPECT_EQ(first[1], all[2]);
}

TEST(VertexImages, whatNoPhotographShowsHasTheMeshsOwnColoursAsBrightAsTheOthers) {
    MeshColours own;
    own.linear = {Rgb(0.4f, 0.4f, 0.4f), Rgb(0.1f), Rgb(0.3f, 0.1f, 0.2f)};
    own.painted = {1, 1, 1};
    const std::vector<Rgb> all = photographColours(threeVertices(), -1, &own);
    EXPECT_FLOAT_EQ(all[0].x, 2);  // five times its own
    EXPECT_FLOAT_EQ(all[1].y, 0.5f);
    EXPECT_FLOAT_EQ(all[2].x, 1.5f);
    EXPECT_FLOAT_EQ(all[2].y, 0.5f);
    own.painted[2] = 0;
    EXPECT_EQ(photographColours(threeVertices(), -1, &own)[2], photographColours(threeVertices())[2]);
}

TEST(VertexImages, differenceIsGreyWhereTheModelIsRightAndPointsTheRightWay) {
    const std::vector<Rgb> right = differenceColours({Rgb(2), Rgb(0.5f), Rgb(1)}, threeVertices());
    EXPECT_NEAR(right[0].x, 0.5f, 1e-3f);
    EXPECT_NEAR(right[1].z, 0.5f, 1e-3f);
    const std::vector<Rgb> wrong = differenceColours({Rgb(9), Rgb(0.01f), Rgb(1)}, threeVertices());
    EXPECT_GT(wrong[0].x, wrong[0].z + 0.5f);  // too bright: orange
    EXPECT_GT(wrong[1].z, wrong[1].x + 0.5f);  // too dark: blue
    EXPECT_EQ(wrong[2], right[2]);             // never seen
}

TEST(VertexImages, confidenceRisesInBrightness) {
    float last = -1;
    for (float c = 0; c <= 1; c += 0.1f) {
        EXPECT_GT(luminance(confidenceColour(c)), last);
        last = luminance(confidenceColour(c));
    }
    EXPECT_EQ(confidenceColour(-3), confidenceColour(0));
}

TEST(VertexImages, clustersAreGreyButForEmitters) {
    Mesh mesh = test::sheet({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, 2, 2);
    const std::vector<uint32_t> emitter = test::append(mesh, test::squareAbove(0.2f, 0, 0, 1));
    const Scene scene = test::sceneOf(mesh);
    const Estimate e =
        test::matteEstimate(scene, Rgb(0.2f, 0.4f, 0.2f), Rgb(1), test::emittersOf(scene, {emitter}, {Rgb(3)}));
    const std::vector<Rgb> colours = clusterColours(e);
    ASSERT_EQ(colours.size(), mesh.vertexCount());
    EXPECT_EQ(colours[0].x, colours[0].y);
    EXPECT_EQ(colours.back(), clusterColour(0));
    EXPECT_NE(clusterColour(0), clusterColour(1));
    // Correction colours keep the tint and drop the brightness.
    const std::vector<Rgb> tint = correctionColours(e);
    EXPECT_NEAR(tint[0].y / tint[0].x, 2, 1e-4f);
    EXPECT_NEAR(luminance(tint[0]), 0.3f, 1e-4f);
}

TEST(VertexImages, irradianceIsFormFactorTimesRadiance) {
    EXPECT_EQ(irradianceColours({0.25f, 0}, Rgb(4, 2, 0))[0], Rgb(1, 0.5f, 0));
}

}  // namespace
}  // namespace relamp
