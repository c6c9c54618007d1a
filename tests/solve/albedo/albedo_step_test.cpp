#include "solve/albedo/albedo_step.h"

#include <gtest/gtest.h>

#include "solve/ratio/pairs.h"
#include "support/shapes.h"

namespace relamp {
namespace {

/// A flat grid of side x side vertices.
Scene flatScene(uint32_t side) {
    Mesh mesh;
    for (uint32_t y = 0; y < side; ++y)
        for (uint32_t x = 0; x < side; ++x) {
            mesh.positions.push_back(Vec3(float(x), float(y), 0) * 0.1f);
            mesh.normals.push_back({0, 0, 1});
        }
    for (uint32_t y = 0; y + 1 < side; ++y)
        for (uint32_t x = 0; x + 1 < side; ++x) {
            const uint32_t v = y * side + x;
            mesh.triangles.push_back({v, v + 1, v + side});
            mesh.triangles.push_back({v + 1, v + side + 1, v + side});
        }
    Progress progress;
    return buildScene(mesh, progress);
}

struct Surface {
    Scene scene = flatScene(20);
    MatteObservations matte;
    std::vector<Rgb> lit, litSigma;
    Surface() {
        matte.componentGlossy.assign(scene.components, 0);
        matte.viewSpread.assign(scene.components, 0);
    }
    void see(uint32_t v, float albedo, float light) {
        matte.vertices.push_back(v);
        matte.radiance.push_back(Rgb(albedo * light));
        matte.sigma.push_back(Rgb(0.01f * albedo * light + 1e-5f));
        lit.push_back(Rgb(light));
        litSigma.push_back(Rgb(0.005f * light));
    }
};

TEST(AlbedoStep, KeepsATextureEdgeThatIsWellSeen) {
    Surface s;
    for (uint32_t v = 0; v < 400; ++v) s.see(v, v % 20 < 10 ? 0.8f : 0.1f, 2.0f);
    Progress progress;
    const AlbedoResult r = solveAlbedo(s.scene, s.matte, s.lit, s.litSigma, {}, progress);
    EXPECT_NEAR(r.albedo[9].x, 0.8f, 0.03f);
    EXPECT_NEAR(r.albedo[10].x, 0.1f, 0.005f);
    EXPECT_GT(r.confidence[200], 0.5f);
}

TEST(AlbedoStep, FillsUnobservedAndUnlitVerticesFromTheirNeighbours) {
    Surface s;
    for (uint32_t v = 0; v < 400; ++v) {
        if (v % 20 > 14) continue;             // never seen
        if (v % 20 > 9) s.see(v, 0.0f, 0.0f);  // seen, but no light falls on it
        else s.see(v, 0.6f, 1.0f);
    }
    Progress progress;
    const AlbedoResult r = solveAlbedo(s.scene, s.matte, s.lit, s.litSigma, {}, progress);
    EXPECT_NEAR(r.albedo[12].x, 0.6f, 0.03f);
    EXPECT_NEAR(r.albedo[19].x, 0.6f, 0.05f);
    EXPECT_LT(r.confidence[19], 0.01f);
}

TEST(AlbedoStep, DoesNotPreferAScale) {
    Surface s, t;
    for (uint32_t v = 0; v < 400; ++v) {
        const float albedo = 0.3f + 0.2f * float(v % 7) / 7;
        s.see(v, albedo, 1.0f);
        t.see(v, albedo, 1.0f);
        t.lit.back() *= 4.0f;  // the same photographs under four times the light
        t.litSigma.back() *= 4.0f;
    }
    Progress progress;
    const AlbedoResult a = solveAlbedo(s.scene, s.matte, s.lit, s.litSigma, {}, progress),
                       b = solveAlbedo(t.scene, t.matte, t.lit, t.litSigma, {}, progress);
    for (uint32_t v = 0; v < 400; v += 13) EXPECT_NEAR(b.albedo[v].x * 4, a.albedo[v].x, 2e-3f * a.albedo[v].x) << v;
}

TEST(AlbedoPairs, JoinMeshNeighboursOfTheSameComponentOnly) {
    Surface s;
    for (uint32_t v = 0; v < 400; ++v) s.see(v, 0.5f, 1.0f);
    const std::vector<AlbedoPair> pairs = albedoPairs(s.scene, s.matte, {});
    size_t edges = 0;
    for (const AlbedoPair& p : pairs) {
        EXPECT_NE(p.a, p.b);
        edges += p.edge;
    }
    EXPECT_EQ(edges, 19u * 20u * 2u + 19u * 19u);  // rows, columns, diagonals
    s.matte.componentGlossy.assign(s.scene.components, 2);
    EXPECT_TRUE(albedoPairs(s.scene, s.matte, {}).empty());
}

MatteObservations everyVertexAlike(const Scene& scene) {
    MatteObservations matte;
    matte.componentGlossy.assign(scene.components, 0);
    for (uint32_t v = 0; v < scene.mesh.vertexCount(); ++v) {
        matte.vertices.push_back(v);
        matte.radiance.push_back(Rgb(1));
        matte.sigma.push_back(Rgb(0.01f));
    }
    return matte;
}

TEST(AlbedoPairs, SomeSpanTheWholeComponentWhereItFacesAlike) {
    // A floor and a wall behind it, one component.
    Mesh mesh = test::sheet({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, 30, 30);
    test::append(mesh, test::sheet({-1, 1, 0}, {2, 0, 0}, {0, 0, 1}, 30, 15));
    const Scene scene = test::sceneOf(std::move(mesh));
    const MatteObservations matte = everyVertexAlike(scene);
    size_t spanning = 0;
    for (const AlbedoPair& p : albedoPairs(scene, matte, {})) {
        const Vec3 d = scene.mesh.positions[matte.vertices[p.a]] - scene.mesh.positions[matte.vertices[p.b]];
        if (glm::length(d) < 1) continue;
        ++spanning;
        EXPECT_GT(glm::dot(scene.mesh.normals[matte.vertices[p.a]], scene.mesh.normals[matte.vertices[p.b]]), 0.69f);
        EXPECT_EQ(scene.component[matte.vertices[p.a]], scene.component[matte.vertices[p.b]]);
    }
    // Two a vertex, and half of the floor is farther than a metre from a vertex.
    EXPECT_GT(spanning, matte.vertices.size() / 2);
    PairOptions none;
    none.longPairs = 0;
    // A walk of 36 steps gets that far now and then.
    size_t withoutThem = 0;
    for (const AlbedoPair& p : albedoPairs(scene, matte, none))
        withoutThem +=
            glm::length(scene.mesh.positions[matte.vertices[p.a]] - scene.mesh.positions[matte.vertices[p.b]]) >= 1;
    EXPECT_LT(withoutThem * 10, spanning);
}

TEST(AlbedoPairs, CornerPairsStayOutOfTheRoundOfACrease) {
    // A floor that goes over into a wall along a quarter of a circle, as reconstruction rounds what was sharp.
    const int flat = 20, round = 4, across = 20;
    Mesh mesh;
    const float step = 0.05f, radius = step * float(round) * 2 / pi;
    for (int i = 0; i <= 2 * flat + round; ++i)
        for (int j = 0; j <= across; ++j) {
            const float turn = std::clamp(float(i - flat) / float(round), 0.0f, 1.0f) * pi / 2;
            const float before = std::min(0.0f, float(i - flat)) * step, after = std::max(0, i - flat - round) * step;
            mesh.positions.push_back(
                {before + radius * std::sin(turn), float(j) * step, radius * (1 - std::cos(turn)) + after});
            mesh.normals.push_back({-std::sin(turn), 0, std::cos(turn)});
        }
    const auto at = [&](int i, int j) { return uint32_t(i * (across + 1) + j); };
    for (int i = 0; i < 2 * flat + round; ++i)
        for (int j = 0; j < across; ++j) {
            mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
            mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
        }
    const Scene scene = test::sceneOf(mesh);
    const MatteObservations matte = everyVertexAlike(scene);
    PairOptions options;
    options.cornerWeight = 0.123f;  // so that they can be told from walks
    size_t corners = 0;
    for (const AlbedoPair& p : albedoPairs(scene, matte, options)) {
        if (p.weight != options.cornerWeight) continue;
        ++corners;
        for (const uint32_t v : {p.a, p.b}) {
            const int i = int(v) / (across + 1);
            EXPECT_TRUE(i < flat || i > flat + round) << i;
        }
    }
    EXPECT_GT(corners, size_t(across));
}

}  // namespace
}  // namespace relamp
