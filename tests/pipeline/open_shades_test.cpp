// Shades of light, open at their ends or closed.
#include "pipeline/open_shades.h"

#include <gtest/gtest.h>

#include "base/random.h"
#include "support/estimates.h"
#include "transport/near_field.h"

namespace relamp {
namespace {

/// A floor of 1681 vertices and, 8 cm above it, a shade of light 10 cm high, as photographs show them.
struct ShadeWorld {
    static constexpr size_t cuts = 40, floorVertices = (cuts + 1) * (cuts + 1);
    EmitterReplacement shade;

    explicit ShadeWorld(double taper) {
        shade.body.axes = glm::dmat3(DVec3(0, 0, 1), DVec3(1, 0, 0), DVec3(0, 1, 0));
        shade.body.centre = {0.05, -0.03, 0.13};
        shade.body.half = {0.05, 0.09, 0.09};
        shade.body.round = true;
        shade.body.taper = taper;
        shade.first = uint32_t(floorVertices);
    }
    Scene scene(bool open) const {
        Mesh mesh = test::sheet({-0.6f, -0.6f, 0}, {1.2f, 0, 0}, {0, 1.2f, 0}, cuts, cuts), body;
        shade.body.surface(body.positions, body.triangles, open);
        body.normals = vertexNormalsFromFaces(body);
        test::append(mesh, body);
        return test::sceneOf(mesh);
    }
    static EmitterClusters lights(const Scene& scene, bool open) {
        EmitterCluster light;
        light.radiance = Rgb(10, 8, 6);
        light.twoSided = open;
        for (uint32_t v = uint32_t(floorVertices); v < scene.mesh.vertexCount(); ++v) light.vertices.push_back(v);
        for (uint32_t t = 0; t < scene.mesh.triangles.size(); ++t)
            if (scene.mesh.triangles[t][0] >= floorVertices) light.triangles.push_back(t);
        measureTriangles(scene, light);
        EmitterClusters all;
        all.emitters.push_back(light);
        indexEmitters(scene, all);
        return all;
    }
    /// Three looks at each vertex, with noise of two percent.
    RadianceSamples seen(bool open, size_t vertices) const {
        const Scene truth = scene(open);
        Progress progress;
        std::vector<float> lit(floorVertices, 0);
        constexpr uint64_t seeds = 24;
        for (uint64_t seed = 100; seed < 100 + seeds; ++seed) {
            const NearField field = computeNearField(truth, lights(truth, open), {seed, nullptr}, progress);
            for (uint32_t v = 0; v < floorVertices; ++v) lit[v] += field.at(v, 0) / float(seeds);
        }
        RadianceSamples samples;
        samples.start.push_back(0);
        for (uint32_t v = 0; v < vertices; ++v) {
            const Vec3 p = truth.mesh.positions[std::min<size_t>(v, floorVertices - 1)];
            const Rgb albedo = Rgb(0.5f, 0.45f, 0.4f) + Rgb(0.1f) * std::sin(9 * p.x) * std::cos(7 * p.y);
            const Rgb shown = v < floorVertices ? albedo * lit[v] * Rgb(10, 8, 6) : Rgb(10, 8, 6);
            for (uint32_t view = 0; view < 3; ++view)
                samples.samples.push_back({view, shown * (0.98f + 0.04f * unitFloat(mixBits(3 * v + view))), 1, false});
            samples.start.push_back(uint32_t(samples.samples.size()));
        }
        samples.relativeNoise = samples.pixelNoise = 0.02f;
        const auto cells = size_t(samples.backgroundGrid.cells());
        samples.background.assign(cells, Rgb(0));
        samples.backgroundPixels.assign(cells, 0);
        samples.backgroundClipped.assign(cells, 0);
        return samples;
    }
    bool opens(bool trulyOpen) const {
        const Scene closed = scene(false);
        std::vector<EmitterReplacement> bodies{shade};
        Progress progress;
        const bool any = openShadeEnds(closed, seen(trulyOpen, closed.mesh.vertexCount()), lights(closed, false),
                                       solveOptionsFor("draft"), bodies, progress);
        EXPECT_EQ(any, bodies[0].open);
        return any;
    }
};

TEST(OpenShades, AreOpenWherePhotographsSaySo) {
    for (const double taper : {0.0, -0.2}) {
        EXPECT_TRUE(ShadeWorld(taper).opens(true)) << taper;
        EXPECT_FALSE(ShadeWorld(taper).opens(false)) << taper;
    }
}

TEST(OpenShades, AreNotAskedForWhatIsLongOrHasADarkEnd) {
    ShadeWorld lampTube(0);
    lampTube.shade.body.half = {0.08, 0.02, 0.02};
    EXPECT_FALSE(lampTube.opens(true));
    ShadeWorld housing(0);
    housing.shade.dark = {0, 1, 0};
    EXPECT_FALSE(housing.opens(true));
}

TEST(OpenShades, TheBackThatItsFrontHidesIsNoNoise) {
    // From afar and aside one sees the outside alone, as that of a closed one.
    const ShadeWorld world(0);
    const Scene open = world.scene(true), closed = world.scene(false);
    Progress progress;
    const NearField sheet = computeNearField(open, ShadeWorld::lights(open, true), {}, progress),
                    body = computeNearField(closed, ShadeWorld::lights(closed, false), {}, progress);
    double squares = 0;
    for (uint32_t v = 0; v <= ShadeWorld::cuts; ++v) squares += std::pow(sheet.at(v, 0) / body.at(v, 0) - 1, 2);
    EXPECT_LT(std::sqrt(squares / double(ShadeWorld::cuts + 1)), 0.02);
}

}  // namespace
}  // namespace relamp
