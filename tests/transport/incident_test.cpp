#include "transport/incident.h"

#include <gtest/gtest.h>

#include <numeric>

#include "base/parallel.h"
#include "base/random.h"
#include "support/shapes.h"
#include "support/stopping.h"
#include "wavelet/haar.h"
#include "wavelet/tripling.h"

namespace relamp {
namespace {

using test::append;

struct Rows {
    Visibility visibility;
    InfluenceMatrix matrix;
};

Rows rowsOf(const Scene& scene, const LightLeaves& leaves, int side, const std::vector<uint32_t>& vertices,
            const EmitterClusters& clusters = {}) {
    Progress progress;
    Rows rows;
    rows.visibility = computeVisibility(scene, {side}, progress);
    const NearField field = computeNearField(scene, clusters, {}, progress);
    rows.matrix = lambertInfluence(scene, rows.visibility, field, leaves, vertices, progress);
    return rows;
}

double sumOfRow(const InfluenceMatrix& m, size_t r) { return std::accumulate(m.row(r), m.row(r) + m.columns, 0.0); }

std::vector<uint32_t> allOf(const Scene& scene) {
    std::vector<uint32_t> all(scene.mesh.vertexCount());
    std::iota(all.begin(), all.end(), 0u);
    return all;
}

TEST(LambertInfluence, OfAConstantEnvironmentOnAnOpenPlaneGivesIrradiancePi) {
    const Scene scene = test::sceneOf(test::sheet({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, 3, 3));
    for (const int side : {32, 64}) {
        const Rows rows = rowsOf(scene, LightLeaves::uniform(4), side, allOf(scene));
        // Cells that the horizon halves are the error: 4 / side^2, 0.1 % at the standard side of 64.
        for (size_t r = 0; r < rows.matrix.rows; ++r)
            EXPECT_NEAR(sumOfRow(rows.matrix, r), 1, 4.2 / (side * side)) << side;
    }
}

TEST(LambertInfluence, IsTheSameForAnyOrientationOfThePlane) {
    for (const Vec3& axis :
         {Vec3(1, 0, 0), Vec3(0, -1, 0), glm::normalize(Vec3(1, 2, -2)), glm::normalize(Vec3(-3, 1, 0.2f))}) {
        const Mat3 frame = frameAround(axis);
        const Scene scene = test::sceneOf(test::sheet(-frame[0] - frame[1], 2.0f * frame[0], 2.0f * frame[1]));
        EXPECT_NEAR(sumOfRow(rowsOf(scene, LightLeaves::uniform(3), 64, {0}).matrix, 0), 1, 2e-3);
    }
}

TEST(LambertInfluence, BesideATallWallIsHalf) {
    Mesh mesh = test::sheet({0.001f, -0.5f, 0}, {1, 0, 0}, {0, 1, 0}, 1, 2);
    append(mesh, test::sheet({0, -3000, -1}, {0, 6000, 0}, {0, 0, 3000}));
    const Scene scene = test::sceneOf(mesh);
    const uint32_t atWall = 2;
    ASSERT_LT(glm::length(scene.mesh.positions[atWall] - Vec3(0.001f, 0, 0)), 1e-5f);
    // The step off the surface is 1e-5 of this large scene, hence the loose bound at the wall's foot.
    EXPECT_NEAR(sumOfRow(rowsOf(scene, LightLeaves::uniform(4), 64, {atWall}).matrix, 0), 0.5, 0.01);
}

TEST(LambertInfluence, OfAnEmitterIsItsFormFactor) {
    Mesh mesh = test::sheet({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, 2, 2);
    const std::vector<uint32_t> emitter = append(mesh, test::squareAbove(1, 0, 0, 1, 4));
    const Scene scene = test::sceneOf(mesh);
    const EmitterClusters clusters = test::emittersOf(scene, {emitter}, {Rgb(5)});
    const Rows rows = rowsOf(scene, LightLeaves::uniform(2), 64, {4}, clusters);
    ASSERT_EQ(rows.matrix.columns, 17u);
    const double expected = test::centredSquareFormFactor(1, 1);
    EXPECT_NEAR(rows.matrix.row(0)[16], expected, 0.005 * expected);
    // The emitter hides exactly its own form factor of the sky.
    EXPECT_NEAR(sumOfRow(rows.matrix, 0), 1, 0.01);
}

TEST(LambertInfluence, OfFineLeavesIsTracedAndAddsUpToTheirParents) {
    Mesh mesh = test::sheet({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, 2, 2);
    append(mesh, test::ball({0.5f, 0.2f, 0.6f}, 0.3f, 10, 16));
    const Scene scene = test::sceneOf(mesh);
    LightLeaves coarse = LightLeaves::uniform(5), fine = coarse;
    const size_t count = coarse.size();
    for (size_t i = 0; i < count; ++i) fine.split(i);  // side 64
    const std::vector<uint32_t> vertices{0, 4, 8};
    const Rows a = rowsOf(scene, coarse, 32, vertices), b = rowsOf(scene, fine, 32, vertices);
    for (size_t r = 0; r < vertices.size(); ++r) {
        EXPECT_NEAR(sumOfRow(a.matrix, r), sumOfRow(b.matrix, r), 0.01) << "one ray a leaf of side 32 against sixteen";
        for (size_t i = 0; i < fine.size(); ++i) ASSERT_GE(b.matrix.row(r)[i], 0);
    }
}

TEST(LambertInfluence, OfLeavesFillsOnlyTheColumnsAskedFor) {
    const Scene scene = test::sceneOf(test::sheet({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, 2, 2));
    const LightLeaves leaves = LightLeaves::uniform(3);
    const std::vector<uint32_t> vertices{0, 3};
    const Rows whole = rowsOf(scene, leaves, 32, vertices);
    InfluenceMatrix part = whole.matrix;
    std::fill(part.values.begin(), part.values.end(), -7.0f);
    Progress progress;
    lambertInfluenceOfLeaves(scene, whole.visibility, leaves, vertices, {5, 20, 63}, part, progress);
    for (size_t r = 0; r < 2; ++r)
        for (size_t i = 0; i < leaves.size(); ++i)
            EXPECT_EQ(part.row(r)[i], i == 5 || i == 20 || i == 63 ? whole.matrix.row(r)[i] : -7.0f);
}

TEST(LambertInfluence, TimesTheLightIsTheTripleProductOfVisibilityCosineAndEnvironment) {
    Mesh mesh = test::sheet({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, 4, 4);
    append(mesh, test::box({-0.3f, -0.2f, 0.1f}, {0.2f, 0.3f, 0.8f}, 2));
    const Scene scene = test::sceneOf(mesh);
    constexpr int side = 32;
    LightLeaves leaves = LightLeaves::uniform(2);
    for (int i = 0; i < 30; ++i) {
        const size_t pick = mixBits(uint64_t(i)) % leaves.size();
        if (leaves[pick].level < 5) leaves.split(pick);
    }
    Lighting lighting{leaves, {}, {}};
    for (size_t i = 0; i < leaves.size(); ++i)
        lighting.leafRadiance.push_back(
            Rgb(unitFloat(mixBits(i)), 10 * unitFloat(mixBits(i + 1000)), i % 7 == 0 ? 100.0f : 0.0f));
    const auto environment = environmentCoefs(lighting, side);
    const std::vector<uint32_t> vertices = allOf(scene);
    const Rows rows = rowsOf(scene, leaves, side, vertices);
    const DirectionGrid grid{side};
    std::vector<float> cosine(size_t(grid.cells()));
    for (const uint32_t v : vertices) {
        for (int c = 0; c < grid.cells(); ++c)
            cosine[size_t(c)] =
                std::max(0.0f, glm::dot(scene.mesh.normals[v], grid.direction(c))) * std::sqrt(grid.cellSolidAngle());
        haarForward(cosine, side);
        const SparseCoefs lobe = sparsify(cosine), seen = visibilityCoefs(rows.visibility, v, 1),
                          product = visibilityCosineCoefs(scene, rows.visibility, v, 1);
        for (int channel = 0; channel < 3; ++channel) {
            double direct = 0;
            for (size_t i = 0; i < leaves.size(); ++i)
                direct += double(rows.matrix.row(v)[i]) * lighting.leafRadiance[i][channel];
            EXPECT_NEAR(tripleProduct(seen, lobe, environment[size_t(channel)], side, 4 * pi) / pi, direct,
                        1e-5 * direct + 1e-6)
                << v;
            EXPECT_NEAR(dot(product, environment[size_t(channel)]) / pi, direct, 2e-5 * direct + 1e-6) << v;
        }
    }
}

TEST(LambertInfluence, HasTheSameBitsOnOneAndManyThreads) {
    Mesh mesh = test::sheet({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, 8, 8);
    append(mesh, test::ball({0.2f, 0, 0.5f}, 0.2f, 6, 9));
    const Scene scene = test::sceneOf(mesh);
    LightLeaves leaves = LightLeaves::uniform(3);
    for (int i = 0; i < 4; ++i) leaves.split(10);
    const auto values = [&](int threads) {
        const ThreadLimit limit(threads);
        return rowsOf(scene, leaves, 32, allOf(scene)).matrix.values;
    };
    EXPECT_EQ(values(1), values(4));
}

TEST(LambertInfluence, StopsHalfWayWhenAsked) {
    const Scene scene = test::sceneOf(test::sheet({-2, -2, 0}, {4, 0, 0}, {0, 4, 0}, 140, 140));
    const LightLeaves leaves = LightLeaves::uniform(5);
    Progress quiet;
    const Visibility visibility = computeVisibility(scene, {64}, quiet);
    const NearField none;
    test::expectStopsHalfWay(
        [&](Progress& progress) { lambertInfluence(scene, visibility, none, leaves, allOf(scene), progress); });
}

/// Directional albedo of a lobe by a fine sum over the hemisphere.
double albedoOf(const Lobe& lobe, const Vec3& eye) {
    const DirectionGrid grid{1024};
    double sum = 0;
    for (int c = 0; c < grid.cells(); ++c) {
        const Vec3 d = grid.direction(c);
        if (d.z > 0) sum += double(evaluateLobe(lobe, d, eye)) * d.z;
    }
    return sum * grid.cellSolidAngle();
}

TEST(GlossyInfluence, OfAConstantEnvironmentIsTheAlbedoOfTheLobe) {
    const Scene scene = test::sceneOf(test::sheet({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}));
    const LightLeaves leaves = LightLeaves::uniform(4);
    std::vector<float> row(leaves.size());
    LobeRowOptions options;
    options.lobeSamples = 4096;
    for (const Lobe& lobe : builtInBasis().lobes) {
        if (lobe.kind == Lobe::Kind::lambert) continue;
        for (const float degrees : {5.0f, 45.0f, 75.0f}) {
            const Vec3 eye(std::sin(glm::radians(degrees)), 0, std::cos(glm::radians(degrees)));
            glossyInfluence(scene, {}, {}, leaves, lobe, 0, eye, options, row.data());
            const double expected = albedoOf(lobe, eye);
            EXPECT_NEAR(std::accumulate(row.begin(), row.end(), 0.0), expected, 0.01 * expected)
                << lobe.name << " at " << degrees;
        }
    }
}

TEST(GlossyInfluence, PutsASharpLobeIntoTheLeafOfTheMirrorDirection) {
    const Scene scene = test::sceneOf(test::sheet({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}));
    const LightLeaves leaves = LightLeaves::uniform(3);
    std::vector<float> row(leaves.size());
    const Vec3 eye = glm::normalize(Vec3(0.5f, 0.2f, 1)), mirror(-eye.x, -eye.y, eye.z);
    glossyInfluence(scene, {}, {}, leaves, {Lobe::Kind::ggx, 0.01f, "mirror"}, 0, eye, {}, row.data());
    const size_t brightest = size_t(std::max_element(row.begin(), row.end()) - row.begin());
    EXPECT_EQ(brightest, leaves.leafOf(mirror));
    EXPECT_GT(row[brightest], 0.7f);
}

/// Integral of lobe x cosine over the solid angle of a square facing down, by a fine sum over its area; `hidden` tells
/// what is blocked.
template <class Hidden>
double lobeTimesSquare(const Lobe& lobe, const Vec3& eye, float side, float x, float y, float z, Hidden&& hidden) {
    constexpr int n = 600;
    double sum = 0;
    for (int j = 0; j < n; ++j)
        for (int i = 0; i < n; ++i) {
            const Vec3 target(x + side * ((i + 0.5f) / n - 0.5f), y + side * ((j + 0.5f) / n - 0.5f), z);
            if (hidden(target)) continue;
            const float d2 = glm::dot(target, target);
            const Vec3 d = target / std::sqrt(d2);
            sum += double(evaluateLobe(lobe, d, eye)) * d.z * d.z / d2;
        }
    return sum * side * side / (double(n) * n);
}

TEST(GlossyInfluence, OfAnEmitterAgreesWithASumOverItsArea) {
    struct Case {
        float side, x, y, z, bound;
        int cuts;
    };
    // A small far emitter, one of half a steradian, and one so near and large that its middle counts many times its
    // corners.
    for (const Case& c :
         {Case{0.2f, 0.8f, 0, 1.5f, 0.02f, 2}, Case{1, 0.5f, 0.2f, 1, 0.02f, 3}, Case{3, 0.4f, 0, 0.6f, 0.03f, 1}}) {
        Mesh mesh = test::sheet({-3, -3, 0}, {6, 0, 0}, {0, 6, 0}, 2, 2);
        const std::vector<uint32_t> emitter = append(mesh, test::squareAbove(c.side, c.x, c.y, c.z, c.cuts));
        const Scene scene = test::sceneOf(mesh);
        const EmitterClusters clusters = test::emittersOf(scene, {emitter}, {Rgb(1)});
        const std::vector<EmitterSurface> surfaces{emitterSurface(scene.mesh, clusters.emitters[0])};
        const LightLeaves leaves = LightLeaves::uniform(1);
        std::vector<float> row(leaves.size() + 1);
        LobeRowOptions options;
        options.lobeSamples = 2048;
        options.emitterSamples = 2048;
        const uint32_t middle = 4;
        for (const Lobe& lobe : {Lobe{Lobe::Kind::ggx, 0.05f, "sharp"}, Lobe{Lobe::Kind::ggx, 0.3f, "wide"},
                                 Lobe{Lobe::Kind::ggxDielectric, 0.5f, "glaze"}})
            for (const Vec3& eye :
                 {Vec3(0, 0, 1), glm::normalize(Vec3(-0.5f, -0.1f, 1)), glm::normalize(Vec3(1, 1, 0.5f))}) {
                glossyInfluence(scene, surfaces, clusters.emitterOfTriangle, leaves, lobe, middle, eye, options,
                                row.data());
                const double expected =
                    lobeTimesSquare(lobe, eye, c.side, c.x, c.y, c.z, [](const Vec3&) { return false; });
                EXPECT_NEAR(row[leaves.size()], expected, c.bound * expected + 1e-4)
                    << lobe.name << ", light of side " << c.side << ", eye " << eye.x << " " << eye.y << " " << eye.z;
            }
    }
}

TEST(GlossyInfluence, OfAnEmitterHalfHiddenIsTheVisibleHalf) {
    Mesh mesh = test::sheet({-3, -3, 0}, {6, 0, 0}, {0, 6, 0}, 2, 2);
    const std::vector<uint32_t> emitter = append(mesh, test::squareAbove(1, 0, 0, 1, 4));
    append(mesh, test::sheet({-3, -3, 0.5f}, {3, 0, 0}, {0, 6, 0}));
    const Scene scene = test::sceneOf(mesh);
    const EmitterClusters clusters = test::emittersOf(scene, {emitter}, {Rgb(1)});
    const std::vector<EmitterSurface> surfaces{emitterSurface(scene.mesh, clusters.emitters[0])};
    const LightLeaves leaves = LightLeaves::uniform(1);
    std::vector<float> row(leaves.size() + 1);
    LobeRowOptions options;
    options.lobeSamples = 1024;
    options.emitterSamples = 1024;
    const Lobe lobe{Lobe::Kind::ggx, 0.3f, "wide"};
    const Vec3 eye = glm::normalize(Vec3(0.4f, 0.1f, 1));
    glossyInfluence(scene, surfaces, clusters.emitterOfTriangle, leaves, lobe, 4, eye, options, row.data());
    const double expected = lobeTimesSquare(lobe, eye, 1, 0, 0, 1, [](const Vec3& p) { return p.x < 0; });
    EXPECT_NEAR(row[leaves.size()], expected, 0.03 * expected);
}

TEST(GlossyInfluence, MirrorsASurfaceAsItDoesASkyOfThatRadiance) {
    // A ceiling that fills the hemisphere but for its last degrees.
    Mesh mesh = test::sheet({-1, -1, 0}, {2, 0, 0}, {0, 2, 0});
    const Scene open = test::sceneOf(mesh);
    append(mesh, test::sheet({-100, -100, 1}, {0, 200, 0}, {200, 0, 0}));
    const Scene closed = test::sceneOf(mesh);
    const LightLeaves leaves = LightLeaves::uniform(2);
    std::vector<float> row(leaves.size());
    std::vector<Rgb> outgoing(mesh.vertexCount(), Rgb(2, 1, 0.5f));
    LobeRowOptions options;
    options.outgoing = &outgoing;
    const Vec3 eye = glm::normalize(Vec3(0.4f, 0.1f, 1));
    const Lobe lobe{Lobe::Kind::ggxDielectric, 0.1f, "glaze"};
    glossyInfluence(open, {}, {}, leaves, lobe, 0, eye, options, row.data());
    const float whole = std::accumulate(row.begin(), row.end(), 0.0f);
    Rgb mirrored(9);
    glossyInfluence(closed, {}, {}, leaves, lobe, 0, eye, options, row.data(), &mirrored);
    EXPECT_NEAR(mirrored.x, 2 * whole, 0.02f * whole);
    EXPECT_NEAR(mirrored.z, 0.5f * whole, 0.01f * whole);
    EXPECT_LT(std::accumulate(row.begin(), row.end(), 0.0f), 0.02f * whole);
    // Its back sends nothing, and without an answer asked for nothing is read.
    for (Triangle& t : mesh.triangles) std::swap(t[1], t[2]);
    Mesh turned = mesh;
    turned.normals = closed.mesh.normals;
    glossyInfluence(test::sceneOf(turned), {}, {}, leaves, lobe, 0, eye, options, row.data(), &mirrored);
    EXPECT_EQ(mirrored.x, 0);
}

TEST(GlossyInfluence, IsZeroForAnEyeBelowTheHorizon) {
    const Scene scene = test::sceneOf(test::sheet({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}));
    const LightLeaves leaves = LightLeaves::uniform(2);
    std::vector<float> row(leaves.size(), 9.0f);
    glossyInfluence(scene, {}, {}, leaves, {Lobe::Kind::ggx, 0.3f, "wide"}, 0, glm::normalize(Vec3(1, 0, -0.5f)), {},
                    row.data());
    for (const float value : row) EXPECT_EQ(value, 0);
}

}  // namespace
}  // namespace relamp
