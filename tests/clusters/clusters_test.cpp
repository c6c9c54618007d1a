#include "clusters/emitter_clusters.h"

#include <gtest/gtest.h>

#include <functional>
#include <set>
#include <tuple>

#include "base/random.h"
#include "radiance/gather.h"
#include "support/estimates.h"
#include "support/shapes.h"

namespace relamp {
namespace {

/// A floor of 40 x 40 quads with side 0.05 m.
Scene floorScene() { return test::sceneOf(test::sheet({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, 40, 40)); }

/// Looks at every vertex from `views` views; `radiance` tells what view i sees of vertex v.
template <class Radiance>
RadianceSamples looks(const Scene& scene, uint32_t views, Radiance&& radiance) {
    RadianceSamples samples;
    for (uint32_t v = 0; v < scene.mesh.vertexCount(); ++v) {
        samples.start.push_back(uint32_t(samples.samples.size()));
        for (uint32_t i = 0; i < views; ++i) samples.samples.push_back({i, radiance(v, i), 1, false});
    }
    samples.start.push_back(uint32_t(samples.samples.size()));
    return samples;
}

EmitterClusters clusters(const Scene& scene, const RadianceSamples& samples) {
    Progress progress;
    return clusterEmitters(scene, Capture{}, samples, {}, progress);
}

/// Shaded floor: between 0.6 and 1.4 with a little noise that differs between views.
Rgb shaded(const Scene& scene, uint32_t v, uint32_t view) {
    const Vec3 p = scene.mesh.positions[v];
    return Rgb((1 + 0.4f * std::sin(2 * p.x) * std::cos(1.5f * p.y)) *
               (1 + 0.02f * (unitFloat(mixBits(v * 31 + view)) - 0.5f)));
}

bool inSquare(const Vec3& p, float x, float y, float half) {
    return std::max(std::abs(p.x - x), std::abs(p.y - y)) < half + 1e-4f;
}

TEST(Clusters, FindNoEmitterWhereThereIsNone) {
    const Scene scene = floorScene();
    const EmitterClusters found =
        clusters(scene, looks(scene, 3, [&](uint32_t v, uint32_t i) { return shaded(scene, v, i); }));
    EXPECT_EQ(found.emitters.size(), 0u);
    EXPECT_EQ(found.candidates.size(), 0u);
    for (const int e : found.emitterOfVertex) EXPECT_EQ(e, -1);
    for (const int e : found.emitterOfTriangle) EXPECT_EQ(e, -1);
}

TEST(Clusters, FindAUniformBrightPatchWithItsVertices) {
    const Scene scene = floorScene();
    const Rgb emitter(60, 50, 40);
    const EmitterClusters found =
        clusters(scene, looks(scene, 3, [&](uint32_t v, uint32_t i) {
                     return inSquare(scene.mesh.positions[v], 0.3f, -0.2f, 0.15f)
                                ? emitter * (1 + 0.01f * (unitFloat(mixBits(v + i * 7919)) - 0.5f))
                                : shaded(scene, v, i);
                 }));
    ASSERT_EQ(found.emitters.size(), 1u);
    const EmitterCluster& e = found.emitters[0];
    EXPECT_EQ(e.id, "emitter-1");
    std::vector<uint32_t> expected;
    for (uint32_t v = 0; v < scene.mesh.vertexCount(); ++v)
        if (inSquare(scene.mesh.positions[v], 0.3f, -0.2f, 0.15f)) expected.push_back(v);
    EXPECT_EQ(expected.size(), 49u);
    EXPECT_EQ(e.vertices, expected);
    EXPECT_EQ(e.triangles.size(), 72u);
    EXPECT_NEAR(e.area, 0.09, 1e-4);
    EXPECT_LT(glm::length(e.centroid - Vec3(0.3f, -0.2f, 0)), 1e-3f);
    EXPECT_LT(glm::length(e.normal - Vec3(0, 0, 1)), 1e-4f);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(e.radiance[c], emitter[c], 0.01f * emitter[c]);
    EXPECT_EQ(e.evidence.viewsSeen, 3);
    EXPECT_GT(e.evidence.sceneContrast, 12);
    EXPECT_LT(e.evidence.edgeDrop, 0.1f);
    for (uint32_t v : expected) EXPECT_EQ(found.emitterOfVertex[v], 0);
    EXPECT_EQ(size_t(std::count(found.emitterOfTriangle.begin(), found.emitterOfTriangle.end(), 0)), 72u);
}

TEST(Clusters, ASpeckOfAPixelIsNoEmitterThoughManyVerticesShowIt) {
    // A very fine mesh under coarse cameras: the bright spot of 49 vertices is one pixel in each of three views, or,
    // seen from near, many.
    const Scene scene = test::sceneOf(test::sheet({-0.1f, -0.1f, 0}, {0.2f, 0, 0}, {0, 0.2f, 0}, 40, 40));
    const RadianceSamples samples = looks(scene, 3, [&](uint32_t v, uint32_t i) {
        return inSquare(scene.mesh.positions[v], 0.03f, -0.02f, 0.015f) ? Rgb(60) : shaded(scene, v, i);
    });
    for (const double focal : {20.0, 2000.0}) {
        Capture capture;
        for (int i = 0; i < 3; ++i) {
            View view;
            view.camera.width = view.camera.height = int(focal);
            view.camera.focalX = view.camera.focalY = focal;
            view.camera.centreX = view.camera.centreY = focal / 2;
            view.camera.worldFromCamera[3] = glm::dvec4(0.05 * i, 0, 1, 1);
            capture.views.push_back(view);
        }
        Progress progress;
        EXPECT_EQ(clusterEmitters(scene, capture, samples, {}, progress).emitters.size(), focal > 100 ? 1u : 0u)
            << focal;
    }
}

TEST(Clusters, ABrightRimOfAHoleIsNoEmitterButABrightSheetIs) {
    // The floor with a hole, a window behind it: the two rows of vertices at the hole's left rim see the window.
    Mesh mesh = test::sheet({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, 40, 40);
    std::erase_if(mesh.triangles, [&](const Triangle& t) {
        return std::all_of(t.begin(), t.end(),
                           [&](uint32_t v) { return inSquare(mesh.positions[v], 0.3f, 0.3f, 0.2f); });
    });
    const Mesh emitter = test::sheet({-0.7f, -0.7f, 0.5f}, {0.2f, 0, 0}, {0, 0.1f, 0}, 4, 2);
    const size_t ofFloor = mesh.vertexCount();
    test::append(mesh, emitter);
    const Scene scene = test::sceneOf(mesh);
    const auto atRim = [&](const Vec3& p) {
        return p.z < 0.1f && p.x > 0.04f && p.x < 0.11f && std::abs(p.y - 0.3f) < 0.16f;
    };
    const EmitterClusters found = clusters(scene, looks(scene, 3, [&](uint32_t v, uint32_t i) {
                                               const Vec3 p = scene.mesh.positions[v];
                                               return v >= ofFloor ? Rgb(80) : atRim(p) ? Rgb(60) : shaded(scene, v, i);
                                           }));
    ASSERT_EQ(found.emitters.size(), 1u);
    EXPECT_EQ(found.emitters[0].vertices.size(), emitter.vertexCount());
    EXPECT_TRUE(std::any_of(found.rejected.begin(), found.rejected.end(), [](const RejectedPatch& r) {
        return r.reason.find("rim of a hole") != std::string::npos;
    }));
}

TEST(Clusters, RejectAHighlightThatMovesWithTheView) {
    const Scene scene = floorScene();
    // A bright spot of 0.3 m that each view sees half a spot further.
    const EmitterClusters found =
        clusters(scene, looks(scene, 4, [&](uint32_t v, uint32_t i) {
                     return inSquare(scene.mesh.positions[v], -0.2f + 0.15f * float(i), 0, 0.15f) ? Rgb(60)
                                                                                                  : shaded(scene, v, i);
                 }));
    EXPECT_EQ(found.emitters.size(), 0u);
    EXPECT_EQ(found.candidates.size(), 0u);
}

TEST(Clusters, KeepAnEmitterThatSomePhotographsShowBrighterForTheLightFit) {
    const Scene scene = floorScene();
    const auto look = [&](const std::function<float(const Vec3&, uint32_t)>& change) {
        return clusters(scene, looks(scene, 4, [&](uint32_t v, uint32_t i) {
                            const Vec3 p = scene.mesh.positions[v];
                            return inSquare(p, 0.3f, -0.2f, 0.15f) ? Rgb(60, 50, 40) * change(p, i)
                                                                   : shaded(scene, v, i);
                        }));
    };
    const EmitterClusters exposed = look([](const Vec3&, uint32_t i) { return 1 + 0.1f * float(i); });
    EXPECT_EQ(exposed.emitters.size(), 0u);
    ASSERT_EQ(exposed.candidates.size(), 1u);
    EXPECT_GT(exposed.candidates[0].evidence.viewSpread, 0.2f);
    // As much change in all, but another one at every vertex; and one that no exposure makes.
    const EmitterClusters wandering =
        look([](const Vec3& p, uint32_t i) { return 1.15f + 0.15f * std::sin(40 * p.x + 1.6f * float(i)); });
    EXPECT_EQ(wandering.emitters.size() + wandering.candidates.size(), 0u);
    const EmitterClusters mirrored = look([](const Vec3&, uint32_t i) { return i == 0 ? 1.0f : 0.4f; });
    EXPECT_EQ(mirrored.emitters.size() + mirrored.candidates.size(), 0u);
}

TEST(Clusters, KeepAnEmitterThatSomethingHidesFromOneViewThoughTheMeshLacksIt) {
    const Scene scene = floorScene();
    const auto found = [&](uint32_t hidden, float change) {
        return clusters(scene, looks(scene, 5, [&](uint32_t v, uint32_t i) {
                            return inSquare(scene.mesh.positions[v], 0.3f, -0.2f, 0.15f) && i >= hidden
                                       ? Rgb(60, 50, 40) * (1 + change * float(i))
                                       : shaded(scene, v, i);
                        }));
    };
    const EmitterClusters one = found(1, 0);
    ASSERT_EQ(one.emitters.size(), 1u);
    EXPECT_LT(one.emitters[0].evidence.viewSpread, 0.01f);
    EXPECT_NEAR(one.emitters[0].radiance.x, 60, 1e-3);
    const EmitterClusters black = clusters(scene, looks(scene, 5, [&](uint32_t v, uint32_t i) {
                                               if (!inSquare(scene.mesh.positions[v], 0.3f, -0.2f, 0.15f))
                                                   return shaded(scene, v, i);
                                               return i < 2 ? Rgb(0) : Rgb(60, 50, 40);
                                           }));
    EXPECT_EQ(black.emitters.size() + black.candidates.size(), 0u);
    // A reflection is alike in few views.
    EXPECT_EQ(found(2, 0).emitters.size() + found(2, 0).candidates.size(), 0u);
    EXPECT_EQ(found(1, 0.1f).emitters.size() + found(1, 0.1f).candidates.size(), 0u);
}

TEST(Clusters, RejectAGlowThatFadesOutWithoutAnEdge) {
    const Scene scene = floorScene();
    const EmitterClusters found = clusters(scene, looks(scene, 3, [&](uint32_t v, uint32_t i) {
                                               const Vec3 p = scene.mesh.positions[v];
                                               return shaded(scene, v, i) * (1 + 40 * std::exp(-12 * glm::dot(p, p)));
                                           }));
    EXPECT_EQ(found.emitters.size(), 0u);
    EXPECT_EQ(found.candidates.size(), 0u);
}

TEST(Clusters, KeepAnEvenDiscWithABlurredEdgeForTheLightFit) {
    const Scene scene = test::sceneOf(test::sheet({-3, -3, 0}, {6, 0, 0}, {0, 6, 0}, 120, 120));
    // As a small ball looks that is larger than the mesh has it: what lies beside it shows its edge, and then its glow.
    const auto disc = [&](float unevenness) {
        const EmitterClusters found =
            clusters(scene, looks(scene, 3, [&](uint32_t v, uint32_t i) {
                         const Vec3 p = scene.mesh.positions[v];
                         const float r = glm::length(p), bright = r < 0.27f   ? 1.0f
                                                                  : r < 0.36f ? 0.84f
                                                                              : 0.7f * std::exp((0.36f - r) / 0.1f);
                         return Rgb(60, 50, 40) * bright * (1 + unevenness * std::sin(25 * p.x)) +
                                (r < 0.36f ? Rgb(0) : shaded(scene, v, i));
                     }));
        EXPECT_EQ(found.emitters.size(), 0u);
        return std::count_if(found.candidates.begin(), found.candidates.end(), [](const EmitterCluster& c) {
            return c.evidence.edgeDrop > 0.8f && std::abs(c.radiance.x - 60) < 3;
        });
    };
    EXPECT_EQ(disc(0), 1);
    // Shading is not even.
    EXPECT_EQ(disc(0.05f), 0);
}

TEST(Clusters, TakeAPartOfUnevenRadianceForOneEmitterOfItsMean) {
    Mesh mesh = test::sheet({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, 40, 40);
    // What an emitter beside it lights looks the same and is none; it hangs above a second square.
    const std::vector<uint32_t> emitter = test::append(mesh, test::squareAbove(0.5f, -0.6f, -0.6f, 0.2f, 4));
    const Scene scene = test::sceneOf(mesh);
    std::vector<uint8_t> onEmitter(scene.mesh.vertexCount(), 0);
    for (uint32_t t : emitter)
        for (uint32_t v : scene.mesh.triangles[t]) onEmitter[v] = 1;
    const auto ramp = [](float along) { return Rgb(40, 30, 20) * (1 + 0.5f * along); };  // 1 : 3 from -1 to 1
    const auto look = [&](bool emitterOn) {
        return clusters(scene, looks(scene, 3, [&](uint32_t v, uint32_t i) {
                            const Vec3 p = scene.mesh.positions[v];
                            if (onEmitter[v]) return Rgb(emitterOn ? 2000.0f : 1.0f);
                            for (const float centre : {0.6f, -0.6f})
                                if (inSquare(p, centre, centre, 0.25f)) return ramp((p.x - centre) / 0.25f);
                            return shaded(scene, v, i);
                        }));
    };
    const EmitterClusters both = look(false), one = look(true);
    EXPECT_EQ(both.emitters.size(), 0u);
    EXPECT_EQ(both.candidates.size(), 2u);
    EXPECT_TRUE(both.rejected.empty()) << both.rejected[0].reason;
    EXPECT_EQ(one.emitters.size(), 1u);
    ASSERT_EQ(one.candidates.size(), 1u);
    const EmitterCluster& found = one.candidates[0];
    EXPECT_EQ(found.vertices.size(), 121u);
    EXPECT_LT(glm::distance(found.centroid, Vec3(0.6f, 0.6f, 0)), 1e-3f);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(found.radiance[c] / ramp(0)[c], 1, 0.01);
    EXPECT_GT(found.radianceSigma, 0.02f);
}

TEST(Clusters, FindAPairOfOneToAThousandBoth) {
    const Scene scene = floorScene();
    const EmitterClusters found = clusters(scene, looks(scene, 3, [&](uint32_t v, uint32_t i) {
                                               const Vec3 p = scene.mesh.positions[v];
                                               return inSquare(p, 0.5f, 0.5f, 0.15f)     ? Rgb(30000)
                                                      : inSquare(p, -0.5f, -0.5f, 0.15f) ? Rgb(30)
                                                                                         : shaded(scene, v, i);
                                           }));
    ASSERT_EQ(found.emitters.size() + found.candidates.size(), 2u);
    ASSERT_EQ(found.emitters.size(), 2u);
    EXPECT_EQ(found.emitters[0].radiance, Rgb(30000)) << "the strongest comes first";
    EXPECT_EQ(found.emitters[1].radiance, Rgb(30));
    EXPECT_EQ(found.emitters[1].id, "emitter-2");
}

/// Emitters on one floor whose places `shines` tells, seen from three views.
size_t emittersWhere(const std::function<bool(const Vec3&)>& shines) {
    const Scene scene = floorScene();
    const auto radiance = [&](uint32_t v, uint32_t i) {
        return shines(scene.mesh.positions[v]) ? Rgb(60, 50, 40) : shaded(scene, v, i);
    };
    return clusters(scene, looks(scene, 3, radiance)).emitters.size();
}

TEST(Clusters, LampsThatAreAlikeOnOneMeshAreSeveral) {
    const auto pair = [](const Vec3& p) { return inSquare(p, -0.5f, 0, 0.15f) || inSquare(p, 0.5f, 0.1f, 0.15f); };
    EXPECT_EQ(emittersWhere(pair), 2u);
}

TEST(Clusters, ALampBehindABarIsOne) {
    const auto barred = [](const Vec3& p) { return inSquare(p, 0, 0, 0.3f) && std::abs(p.x) > 0.07f; };
    EXPECT_EQ(emittersWhere(barred), 1u);
}

TEST(Clusters, KeepAModeratelyBrightPatchAsACandidateForTheLightFit) {
    const Scene scene = floorScene();
    const EmitterClusters found =
        clusters(scene, looks(scene, 3, [&](uint32_t v, uint32_t i) {
                     return inSquare(scene.mesh.positions[v], 0.3f, -0.2f, 0.15f) ? Rgb(5) : shaded(scene, v, i);
                 }));
    EXPECT_EQ(found.emitters.size(), 0u);
    EXPECT_EQ(found.candidates.size(), 1u);
}

TEST(Clusters, WhatShowsABrighterCandidatePastItsEdgeIsNone) {
    // A sheet over the floor shines, and so does a part of the floor beside its image: a few pixels from it or many, as
    // the photographs are fine.
    Mesh mesh = test::sheet({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, 40, 40);
    test::append(mesh, test::sheet({0, -0.3, 0.2}, {0.5, 0, 0}, {0, 0.5, 0}, 10, 10));
    const size_t floorVertices = mesh.vertexCount() - 121;
    const Scene scene = test::sceneOf(mesh);
    const auto candidates = [&](int width) {
        Capture capture;
        for (const double x : {0.1, 0.5}) {
            View view;
            view.camera = test::cameraAt({x, -0.1, 3}, {0.3, 0, 0}, width, width, width);
            view.image = Image(width, width, Rgb(1));
            capture.views.push_back(view);
        }
        Progress progress;
        RadianceSamples samples = gatherRadiance(capture, scene, {}, progress);
        for (uint32_t v = 0; v < scene.mesh.vertexCount(); ++v)
            for (uint32_t s = samples.start[v]; s < samples.start[v + 1]; ++s) {
                const bool shines = v >= floorVertices || inSquare(scene.mesh.positions[v], 0.25f, 0.45f, 0.1f);
                samples.samples[s].radiance = shines ? Rgb(5) : shaded(scene, v, samples.samples[s].view);
            }
        return clusterEmitters(scene, capture, samples, {}, progress).candidates.size();
    };
    EXPECT_EQ(candidates(60), 1u);
    EXPECT_EQ(candidates(600), 2u);
}

TEST(Clusters, TakeAWholeBulbWhenItsSeenSideShines) {
    Mesh mesh = test::sheet({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, 30, 30);
    const size_t floorVertices = mesh.vertexCount();
    const std::vector<uint32_t> bulb = test::append(mesh, test::ball({0, 0, 0.5f}, 0.1f, 10, 14));
    const Scene scene = test::sceneOf(mesh);
    RadianceSamples samples;
    for (uint32_t v = 0; v < scene.mesh.vertexCount(); ++v) {
        samples.start.push_back(uint32_t(samples.samples.size()));
        const bool onBulb = v >= floorVertices;
        if (onBulb && scene.mesh.normals[v].x < 0.1f) continue;  // the far side was not seen
        for (uint32_t i = 0; i < 2; ++i)
            samples.samples.push_back({i, onBulb ? Rgb(80, 70, 60) : shaded(scene, v, i), 1, false});
    }
    samples.start.push_back(uint32_t(samples.samples.size()));
    const EmitterClusters found = clusters(scene, samples);
    ASSERT_EQ(found.emitters.size(), 1u);
    std::vector<uint32_t> triangles = found.emitters[0].triangles;
    std::sort(triangles.begin(), triangles.end());
    EXPECT_EQ(triangles, bulb);
    EXPECT_LT(glm::length(found.emitters[0].centroid - Vec3(0, 0, 0.5f)), 0.005f);
    EXPECT_EQ(found.emitters[0].normal, Vec3(0)) << "a closed part has no side";
}

TEST(Clusters, OfNothingSeenAreNone) {
    const Scene scene = floorScene();
    const EmitterClusters found = clusters(scene, looks(scene, 0, [](uint32_t, uint32_t) { return Rgb(1); }));
    EXPECT_TRUE(found.emitters.empty() && found.candidates.empty());
    EXPECT_EQ(found.emitterOfVertex.size(), scene.mesh.vertexCount());
}

TEST(Clusters, AreIndexedByPowerAndNamedInThatOrder) {
    Mesh mesh = test::squareAbove(1, 0, 0, 1);
    const std::vector<uint32_t> first{0, 1}, second = test::append(mesh, test::squareAbove(2, 5, 0, 1));
    const Scene scene = test::sceneOf(mesh);
    // 1 m2 of radiance 3 against 4 m2 of radiance 1.
    const EmitterClusters found = test::emittersOf(scene, {first, second}, {Rgb(3), Rgb(1)});
    EXPECT_EQ(found.emitters[0].radiance, Rgb(1));
    EXPECT_EQ(found.emitters[0].id, "emitter-1");
    EXPECT_EQ(found.emitterOfTriangle, (std::vector<int>{1, 1, 0, 0}));
}

TEST(Clusters, DoNotCareForTheOrderOfTheFile) {
    // An emitter that is brighter in the middle, so that what joins it rests on what joined before, in a file turned
    // round.
    Mesh mesh = test::sheet({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, 30, 30);
    const uint32_t count = uint32_t(mesh.vertexCount());
    const auto radianceAt = [](const Vec3& p) {
        return Rgb(p.x * p.x + p.y * p.y < 0.16f ? 60 + 6 * p.x + 4 * p.y * p.y : 1.0f);
    };
    const auto found = [&](const Mesh& m) {
        const Scene scene = test::sceneOf(m);
        RadianceSamples samples;
        for (uint32_t v = 0; v < m.vertexCount(); ++v) {
            samples.start.push_back(uint32_t(samples.samples.size()));
            for (uint32_t i = 0; i < 2; ++i) samples.samples.push_back({i, radianceAt(m.positions[v]), 1, false});
        }
        samples.start.push_back(uint32_t(samples.samples.size()));
        const EmitterClusters emitters = clusters(scene, samples);
        std::vector<Vec3> middles;
        for (const EmitterCluster& e : emitters.emitters)
            for (const uint32_t t : e.triangles)
                middles.push_back(
                    (m.positions[m.triangles[t][0]] + m.positions[m.triangles[t][1]] + m.positions[m.triangles[t][2]]) /
                    3.0f);
        std::sort(middles.begin(), middles.end(),
                  [](const Vec3& a, const Vec3& b) { return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z); });
        return middles;
    };
    Mesh turned = mesh;
    for (uint32_t v = 0; v < count; ++v) {
        turned.positions[v] = mesh.positions[count - 1 - v];
        turned.normals[v] = mesh.normals[count - 1 - v];
    }
    for (Triangle& t : turned.triangles)
        for (uint32_t& v : t) v = count - 1 - v;
    std::reverse(turned.triangles.begin(), turned.triangles.end());
    const std::vector<Vec3> plain = found(mesh), other = found(turned);
    ASSERT_GT(plain.size(), 50u);
    EXPECT_EQ(plain, other);
}

}  // namespace
}  // namespace relamp
