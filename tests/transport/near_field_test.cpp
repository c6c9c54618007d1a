#include "transport/near_field.h"

#include <gtest/gtest.h>

#include <bit>

#include "base/parallel.h"
#include "support/shapes.h"
#include "wavelet/haar.h"

namespace relamp {
namespace {

using test::append;

const Vec3 up(0, 0, 1);

/// Sum of exact form factors over the triangles of a mesh.
double exactFormFactor(const Mesh& mesh, const Vec3& point, const Vec3& normal, bool twoSided = false) {
    double sum = 0;
    for (const Triangle& t : mesh.triangles)
        sum += triangleFormFactor(point, normal, {mesh.positions[t[0]], mesh.positions[t[1]], mesh.positions[t[2]]},
                                  twoSided);
    return sum;
}

EmitterCluster wholeMesh(const Mesh& mesh) {
    EmitterCluster cluster;
    for (uint32_t t = 0; t < mesh.triangles.size(); ++t) cluster.triangles.push_back(t);
    return cluster;
}

TEST(EmitterSurface, KeepsTheOrderOfTheClustersTriangles) {
    // Samplers go from the n-th triangle of a cluster to the n-th of its surface: another order gives wrong densities
    // and bright specks.
    Mesh mesh = test::sheet({1, 0, 0}, {-2, 0, 0}, {0, 2, 0}, 4, 4);
    EmitterCluster cluster = wholeMesh(mesh);
    std::swap(cluster.triangles[3], cluster.triangles[20]);
    const EmitterSurface surface = emitterSurface(mesh, cluster);
    ASSERT_EQ(surface.corners.size(), cluster.triangles.size());
    for (size_t i = 0; i < surface.corners.size(); ++i)
        for (size_t k = 0; k < 3; ++k)
            EXPECT_EQ(surface.corners[i][k], mesh.positions[mesh.triangles[cluster.triangles[i]][k]]) << i;
}

TEST(EmitterSurface, ForSolvingDoesNotKnowTheOrderOfTheFile) {
    const Mesh mesh = test::ball({0, 0, 0.5f}, 0.1f, 10, 14);
    EmitterCluster cluster = wholeMesh(mesh), reversed = cluster;
    std::reverse(reversed.triangles.begin(), reversed.triangles.end());
    Progress progress;
    const Scene scene = buildScene(mesh, progress);
    const EmitterSurface a = orderedEmitterSurface(scene, cluster), b = orderedEmitterSurface(scene, reversed);
    EXPECT_EQ(a.corners, b.corners);
    EXPECT_EQ(a.corners.size(), emitterSurface(mesh, cluster).corners.size());
    EXPECT_NE(emitterSurface(mesh, cluster).corners, emitterSurface(mesh, reversed).corners);
}

TEST(FormFactor, OfADiscAbovePlaneIsItsRadiusSquaredOverTheDistanceToItsRimSquared) {
    for (const float height : {0.05f, 0.3f, 1.0f, 4.0f, 20.0f}) {
        // The polygon of 720 sides lacks 1.3e-5 of the disc's area.
        EXPECT_NEAR(exactFormFactor(test::discAbove(1, height, 720), Vec3(0), up) / (1 / (1 + double(height) * height)),
                    1, 2e-4)
            << height;
    }
}

TEST(FormFactor, OfASquareAbovePlaneIsTheCatalogueValueAtSeveralHeights) {
    for (const float height : {0.02f, 0.1f, 0.5f, 1.0f, 3.0f, 8.0f}) {
        const double expected = test::centredSquareFormFactor(1, height);
        EXPECT_NEAR(exactFormFactor(test::squareAbove(1, 0, 0, height), Vec3(0), up), expected, 1e-4 * expected + 1e-7)
            << height;
        EXPECT_NEAR(exactFormFactor(test::squareAbove(1, 0, 0, height, 7), Vec3(0), up), expected,
                    2e-4 * expected + 1e-7)
            << height;
    }
}

TEST(FormFactor, OfASquareToTheSideIsTheDifferenceOfCatalogueRectangles) {
    for (const float x : {0.3f, 0.5f, 2.0f, 5.0f}) {
        const double expected = test::rectangleFormFactor(x - 0.5, x + 0.5, -0.5, 0.5, 1);
        EXPECT_NEAR(exactFormFactor(test::squareAbove(1, x, 0, 1), Vec3(0), up), expected, 1e-6) << x;
    }
}

TEST(FormFactor, OfAnUprightRectangleThatStandsOnTheHorizonIsTheCatalogueValue) {
    // Faces -X; its lower edge lies in the plane of the point.
    const Mesh wall = test::sheet({2, -0.5f, 0}, {0, 0, 3}, {0, 1, 0});
    ASSERT_LT(wall.normals[0].x, -0.99f);
    const double expected = 2 * test::uprightFormFactor(3, 0.5, 2);
    EXPECT_NEAR(exactFormFactor(wall, Vec3(0), up), expected, 1e-6);
    // What lies below the horizon adds nothing.
    EXPECT_NEAR(exactFormFactor(test::sheet({2, -0.5f, -4}, {0, 0, 7}, {0, 1, 0}), Vec3(0), up), expected, 1e-6);
    EXPECT_EQ(exactFormFactor(test::sheet({2, -0.5f, -4}, {0, 0, 3}, {0, 1, 0}), Vec3(0), up), 0);
}

TEST(FormFactor, AveragedOverASquareGivesTheExchangeOfParallelUnitSquares) {
    const Mesh above = test::squareAbove(1, 0, 0, 1);
    double sum = 0;
    constexpr int n = 40;
    for (int y = 0; y < n; ++y)
        for (int x = 0; x < n; ++x)
            sum += exactFormFactor(above, Vec3((x + 0.5f) / n - 0.5f, (y + 0.5f) / n - 0.5f, 0), up);
    // Howell's catalogue C-11 for X = Y = 1.
    EXPECT_NEAR(sum / (n * n), 0.19982, 5e-5);
}

TEST(FormFactor, OfAHugeSheetCloseAboveIsOne) {
    EXPECT_NEAR(exactFormFactor(test::squareAbove(2000, 0, 0, 0.1f), Vec3(0.3f, 0.1f, 0), up), 1, 1e-4);
}

TEST(FormFactor, CountsOnlyTheFrontUnlessTwoSided) {
    const Mesh away = test::sheet({-0.5f, -0.5f, 1}, {1, 0, 0}, {0, 1, 0});
    EXPECT_EQ(exactFormFactor(away, Vec3(0), up), 0);
    EXPECT_NEAR(exactFormFactor(away, Vec3(0), up, true), test::centredSquareFormFactor(1, 1), 1e-6);
}

TEST(FormFactor, IsFiniteAndRightForTouchingCoplanarAndDegenerateTriangles) {
    const std::array<Vec3, 3> down{Vec3(0, 0, 1), Vec3(0, 1, 1), Vec3(1, 0, 1)};
    EXPECT_GT(triangleFormFactor(Vec3(0.2f, 0.2f, 0), up, down, false), 0);
    EXPECT_EQ(triangleFormFactor(Vec3(0, 0, 1), up, down, false), 0) << "at a corner";
    EXPECT_EQ(triangleFormFactor(Vec3(0, 0, 1), up, down, true), 0) << "at a corner, two-sided";
    EXPECT_EQ(triangleFormFactor(Vec3(3, 3, 1), up, down, false), 0) << "in its plane";
    EXPECT_NEAR(triangleFormFactor(Vec3(3, 3, 1), up, down, true), 0, 1e-6) << "in its plane, two-sided";
    EXPECT_EQ(triangleFormFactor(Vec3(0.2f, 0.2f, 2), up, down, false), 0) << "below the horizon";
    EXPECT_EQ(triangleFormFactor(Vec3(0.2f, 0.2f, 2), up, down, true), 0) << "below the horizon, two-sided";
    const std::array<Vec3, 3> line{Vec3(0, 0, 1), Vec3(1, 0, 1), Vec3(2, 0, 1)}, point{Vec3(1), Vec3(1), Vec3(1)};
    for (const bool twoSided : {false, true}) {
        EXPECT_NEAR(triangleFormFactor(Vec3(0.5f, 1, 0), up, line, twoSided), 0, 1e-7);
        EXPECT_NEAR(triangleFormFactor(Vec3(0.5f, 1, 0), up, point, twoSided), 0, 1e-7);
    }
    // A hair above the emitter's middle it fills the whole hemisphere, a hair beside its edge's end a quarter.
    const Mesh square = test::squareAbove(1, 0, 0, 1e-5f);
    EXPECT_NEAR(exactFormFactor(square, Vec3(0), up), 1, 1e-3);
    EXPECT_NEAR(exactFormFactor(square, Vec3(0.5f, 0.5f, 0), up), 0.25, 1e-3);
}

TEST(EmitterSurface, LeavesOutTrianglesWithoutAreaAndMeasuresTheRest) {
    Mesh mesh = test::squareAbove(2, 1, 1, 3);
    mesh.triangles.push_back({0, 1, 1});
    const EmitterSurface surface = emitterSurface(mesh, wholeMesh(mesh));
    EXPECT_EQ(surface.corners.size(), 2u);
    EXPECT_FLOAT_EQ(surface.area(), 4);
    EXPECT_LT(glm::length(surface.centroid - Vec3(1, 1, 3)), 1e-5f);
    EXPECT_GE(surface.radius, std::sqrt(2.0f) - 1e-5f);
}

TEST(EmitterSurface, KeepsFacingOutwardsWhenMirrored) {
    const Mesh mesh = test::squareAbove(1, 0, 0, 1);
    const Mat4 mirror = Mat4(Vec4(-1, 0, 0, 0), Vec4(0, 1, 0, 0), Vec4(0, 0, 1, 0), Vec4(0, 0, 0, 1));
    for (const Vec3& n : emitterSurface(mesh, wholeMesh(mesh), mirror).normals) EXPECT_LT(n.z, -0.999f);
}

TEST(SampleEmitter, SumsToTheUnshadowedFormFactor) {
    Mesh mesh = test::sheet({-4, -4, 0}, {8, 0, 0}, {0, 8, 0});
    const std::vector<uint32_t> triangles = append(mesh, test::squareAbove(1, 0, 0, 1, 4));
    const Scene scene = test::sceneOf(mesh);
    EmitterCluster cluster;
    cluster.triangles = triangles;
    const EmitterSurface surface = emitterSurface(scene.mesh, cluster);
    std::vector<EmitterSample> samples;
    for (const float x : {0.0f, 0.4f, 1.5f, 3.9f})
        for (const int count : {0, 1, 7, 64}) {
            const float total = sampleEmitter(scene, surface, Vec3(x, 0, 0), up, count, 5, samples);
            EXPECT_NEAR(total, test::rectangleFormFactor(-0.5 - x, 0.5 - x, -0.5, 0.5, 1), 0.01 * total) << x;
            double sum = 0;
            for (const EmitterSample& s : samples) {
                sum += s.formFactor;
                EXPECT_EQ(s.visible, 1);
                EXPECT_NEAR(glm::length(s.direction), 1, 1e-5);
                // Every sample points at the emitter.
                const Vec3 end = Vec3(x, 0, 0) + s.direction / s.direction.z;
                EXPECT_LT(std::max(std::abs(end.x), std::abs(end.y)), 0.502f);
            }
            EXPECT_NEAR(sum, total, 1e-5 * total);
            if (count) { EXPECT_EQ(samples.size(), size_t(count)); }
        }
    EXPECT_EQ(sampleEmitter(scene, surface, Vec3(0, 0, 2), up, 16, 5, samples), 0) << "the light is below the horizon";
    EXPECT_TRUE(samples.empty());
}

TEST(SampleEmitter, SmallTrianglesFarAwayKeepTheFormFactorToHalfAPerCent) {
    // At eight radii exact form factors hand over to those of the triangles' centres.
    Mesh mesh = test::squareAbove(1, 0, 0, 0, 4);
    const EmitterSurface surface = emitterSurface(mesh, wholeMesh(mesh));
    const Scene scene = test::sceneOf(mesh);
    std::vector<EmitterSample> samples;
    for (float height = 0.4f; height < 6; height *= 1.17f)
        for (const float x : {0.0f, 0.7f, 2.0f}) {
            const float total = sampleEmitter(scene, surface, Vec3(x, 0.1f, -height), up, 1, 1, samples);
            const double expected = test::rectangleFormFactor(-0.5 - x, 0.5 - x, -0.6, 0.4, height);
            EXPECT_NEAR(total / expected, 1, 5e-3) << height << " " << x;
        }
}

TEST(SampleEmitter, IsBlindBehindAnOccluderAndSeesHalfBesideAnEdge) {
    Mesh mesh = test::sheet({-4, -4, 0}, {8, 0, 0}, {0, 8, 0});
    const std::vector<uint32_t> triangles = append(mesh, test::squareAbove(1, 0, 0, 2, 4));
    append(mesh, test::sheet({-8, -8, 1}, {8, 0, 0}, {0, 16, 0}));  // blocks all with x < 0 at height 1
    const Scene scene = test::sceneOf(mesh);
    EmitterCluster cluster;
    cluster.triangles = triangles;
    const EmitterSurface surface = emitterSurface(scene.mesh, cluster);
    std::vector<EmitterSample> samples;
    const auto seen = [&](float x) {
        const float total = sampleEmitter(scene, surface, Vec3(x, 0, 0), up, 256, 3, samples);
        double sum = 0;
        for (const EmitterSample& s : samples) sum += s.formFactor * s.visible;
        return sum / total;
    };
    EXPECT_EQ(seen(-2), 0);
    EXPECT_NEAR(seen(0), 0.5, 0.02);
    EXPECT_NEAR(seen(2), 1, 1e-5);
}

TEST(SampleEmitter, DoesNotSpreadFormFactorByAreaWhereAnEmitterIsLargeAndNear) {
    // Over a sheet of 4 x 4 m half a metre away most light comes from close by: what an occluder over x < -0.5 hides is
    // far less than its fraction of the area.
    Mesh mesh = test::sheet({-3, -3, 0}, {6, 0, 0}, {0, 6, 0});
    const std::vector<uint32_t> triangles = append(mesh, test::squareAbove(4, 0, 0, 0.5f));
    append(mesh, test::sheet({-3, -3, 0.45f}, {2.5f, 0, 0}, {0, 6, 0}));
    const Scene scene = test::sceneOf(mesh);
    EmitterCluster cluster;
    cluster.triangles = triangles;
    const EmitterSurface surface = emitterSurface(scene.mesh, cluster);
    std::vector<EmitterSample> samples;
    const float total = sampleEmitter(scene, surface, Vec3(0), up, 256, 3, samples);
    EXPECT_NEAR(total, test::centredSquareFormFactor(4, 0.5), 1e-3);
    double seen = 0;
    for (const EmitterSample& s : samples) seen += s.formFactor * s.visible;
    // Seen through the plane z = 0.45: x > -0.5 there is x > -0.5 / 0.9 at the emitter.
    EXPECT_NEAR(seen, test::rectangleFormFactor(-0.5 / 0.9, 2, -2, 2, 0.5), 0.015);
}

TEST(NearField, HoldsTheShadowedAndTheUnshadowedFormFactorOfEachVertex) {
    Mesh mesh = test::sheet({-4, -1, 0}, {8, 0, 0}, {0, 2, 0}, 16, 2);
    const size_t floorVertices = mesh.vertexCount();
    const std::vector<uint32_t> first = append(mesh, test::squareAbove(1, -2, 0, 2, 3)),
                                second = append(mesh, test::squareAbove(0.5f, 2, 0, 1, 3));
    append(mesh, test::sheet({-0.01f, -5, 0.1f}, {0, 10, 0}, {0, 0, 6}));  // a wall between the two halves
    const Scene scene = test::sceneOf(mesh);
    const EmitterClusters clusters = test::emittersOf(scene, {first, second}, {Rgb(1), Rgb(1)});
    Progress progress;
    const NearField field = computeNearField(scene, clusters, {}, progress);
    ASSERT_EQ(field.emitters, 2u);
    for (uint32_t v = 0; v < floorVertices; ++v) {
        const Vec3 p = scene.mesh.positions[v];
        const double a = test::rectangleFormFactor(-2.5 - p.x, -1.5 - p.x, -0.5 - p.y, 0.5 - p.y, 2),
                     b = test::rectangleFormFactor(1.75 - p.x, 2.25 - p.x, -0.25 - p.y, 0.25 - p.y, 1);
        EXPECT_NEAR(field.unshadowed[v * 2], a, 0.008 * a);
        EXPECT_NEAR(field.unshadowed[v * 2 + 1], b, 0.008 * b);
        if (std::abs(p.x) < 1.6f) continue;  // light that slips under the wall
        EXPECT_NEAR(field.at(v, 0), p.x < 0 ? field.unshadowed[v * 2] : 0.0f, 1e-6f) << p.x;
        EXPECT_NEAR(field.at(v, 1), p.x > 0 ? field.unshadowed[v * 2 + 1] : 0.0f, 1e-6f) << p.x;
    }
}

TEST(NearField, HasTheSameBitsOnOneAndManyThreads) {
    Mesh mesh = test::sheet({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, 20, 20);
    const std::vector<uint32_t> emitter = append(mesh, test::ball({0.3f, 0.2f, 0.7f}, 0.1f, 6, 8));
    append(mesh, test::box({-0.3f, -0.3f, 0.1f}, {0.1f, 0.1f, 0.4f}));
    const Scene scene = test::sceneOf(mesh);
    const EmitterClusters clusters = test::emittersOf(scene, {emitter}, {Rgb(1)});
    const auto field = [&](int threads) {
        const ThreadLimit limit(threads);
        Progress progress;
        return computeNearField(scene, clusters, {}, progress).formFactor;
    };
    EXPECT_EQ(field(1), field(4));
}

TEST(NearFieldCoefs, TimesTheCosineAreThePiFoldFormFactor) {
    // The double product of the emitter's map with the cosine lobe against area sampling.
    Mesh mesh = test::sheet({-4, -4, 0}, {8, 0, 0}, {0, 8, 0}, 2, 2);
    const std::vector<uint32_t> triangles = append(mesh, test::squareAbove(1.5f, 0.4f, 0, 1, 6));
    const Scene scene = test::sceneOf(mesh);
    EmitterCluster cluster;
    cluster.triangles = triangles;
    const EmitterSurface surface = emitterSurface(scene.mesh, cluster);
    const DirectionGrid grid{32};
    std::vector<float> cosine(size_t(grid.cells()));
    for (int c = 0; c < grid.cells(); ++c)
        cosine[size_t(c)] = std::max(0.0f, grid.direction(c).z) * std::sqrt(grid.cellSolidAngle());
    haarForward(cosine, grid.side);
    const uint32_t vertex = 4;  // the middle of the floor
    ASSERT_EQ(scene.mesh.positions[vertex], Vec3(0));
    const SparseCoefs map = nearFieldCoefs(scene, surface, vertex, grid, 4096, 1);
    // Sampling noise of covered cells is cut at a fraction of 1, which costs 2.5 % here.
    const double expected = test::rectangleFormFactor(-0.35, 1.15, -0.75, 0.75, 1);
    EXPECT_NEAR(dot(map, cosine) / pi, expected, 0.035 * expected);
    // Fractions of cells lie between 0 and 1.
    std::vector<float> cells(size_t(grid.cells()));
    scatter(map, cells);
    haarInverse(cells, grid.side);
    for (float& fraction : cells) {
        fraction /= std::sqrt(grid.cellSolidAngle());
        EXPECT_GT(fraction, -1e-4f);
        EXPECT_LT(fraction, 1 + 1e-4f);
    }
    // The middle of the emitter is covered, and what is far from it is not.
    EXPECT_GT(cells[size_t(grid.cellOf(glm::normalize(Vec3(0.4f, 0, 1))))], 0.9f);
    EXPECT_NEAR(cells[size_t(grid.cellOf(glm::normalize(Vec3(-2, 0, 1))))], 0, 1e-4);
}

}  // namespace
}  // namespace relamp
