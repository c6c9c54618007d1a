#include <gtest/gtest.h>

#include "base/parallel.h"
#include "base/random.h"
#include "relight/live/gloss_triple.h"
#include "relight/live/live_scene.h"
#include "support/estimates.h"

namespace relamp {
namespace {

/// A soft gradient with one bright window; `sun`: also a few cells a thousand times brighter.
DistantLight skyOf(int side, bool sun) {
    const DirectionGrid grid{side};
    std::vector<Rgb> cells(size_t(grid.cells()));
    for (int c = 0; c < grid.cells(); ++c) {
        const Vec3 d = grid.direction(c);
        cells[size_t(c)] = Rgb(0.3f, 0.4f, 0.6f) * (1 + d.z) +
                           (glm::dot(d, glm::normalize(Vec3(1, 1, 1))) > 0.95f ? Rgb(3, 2, 1) : Rgb(0));
        if (sun && glm::dot(d, glm::normalize(Vec3(-1, 0.3f, 1))) > 0.999f) cells[size_t(c)] += Rgb(800, 700, 600);
    }
    return DistantLight(grid, std::move(cells));
}

/// Half of the sky is hidden.
std::vector<uint8_t> halfHidden(const LiveGrid& grid, const Vec3& normal) {
    std::vector<uint8_t> masks(grid.nibbleBytes(), 0);
    for (size_t c = 0; c < grid.cells(); ++c) {
        unsigned seen = 0;
        for (int q = 0; q < 4; ++q)
            if (const Vec3 d = grid.quarter(c, q); glm::dot(d, normal) > 0 && d.x > -0.7f) seen |= 1u << q;
        setNibble(masks.data(), c, seen);
    }
    return masks;
}

struct Point {
    Vec3 normal = glm::normalize(Vec3(0.2f, 0.1f, 1));
    Mat3 frame = frameAround(normal);
    Vec3 eye = glm::normalize(Vec3(0.5f, -0.3f, 0.6f));
};

/// Every cell of the environment behind the masks of its quarter.
Rgb everyCell(const DistantLight& distant, const BrdfBasis& basis, const std::vector<LobeWeight>& lobes, const Point& p,
              const LiveGrid& grid, const std::vector<uint8_t>& masks) {
    Rgb sum(0);
    for (int c = 0; c < distant.grid().cells(); ++c) {
        const Vec3 d = distant.grid().direction(c), light = glm::transpose(p.frame) * d;
        const size_t q = grid.quarterAt(sphereToSquare(d));
        if (light.z <= 0 || !(nibbleOf(masks.data(), q / 4) >> (q % 4) & 1)) continue;
        Rgb value(0);
        for (const LobeWeight& l : lobes) value += l.weight * evaluateLobe(basis.lobes[l.lobe], light, p.eye);
        sum += value * light.z * distant.cells()[size_t(c)];
    }
    return sum * distant.grid().cellSolidAngle();
}

TEST(LiveGlossTriple, FullTermsGiveTheSumOverTheGrid) {
    const LiveGrid grid(16);
    const DistantLight sky = skyOf(64, true);
    const TripleGloss triple(grid, sky, {});
    const BrdfBasis basis = builtInBasis();
    const Point p;
    const std::vector<uint8_t> masks = halfHidden(grid, p.normal);
    const SparseCoefs seen = triple.visibility(masks.data());
    for (const uint8_t k : {uint8_t(3), uint8_t(6), uint8_t(10)}) {
        const std::vector<LobeWeight> lobes{{k, Rgb(1)}};
        const Rgb whole = triple.onGrid(basis, lobes, p.frame, p.eye, masks.data()),
                  walked = triple.light(seen, triple.reflectance(basis.lobes[k], p.frame, p.eye));
        for (int c = 0; c < 3; ++c) EXPECT_NEAR(walked[c], whole[c], 2e-5f * whole[c]) << int(k);
    }
}

TEST(LiveGlossTriple, FewerTermsComeCloserAsTheyGrow) {
    const LiveGrid grid(16);
    const DistantLight sky = skyOf(64, false);
    const BrdfBasis basis = builtInBasis();
    const Point p;
    const std::vector<uint8_t> masks = halfHidden(grid, p.normal);
    const std::vector<LobeWeight> lobes{{5, Rgb(1)}};
    float before = 1e30f;
    for (const size_t terms : {8, 64, 1024}) {
        const TripleGloss triple(grid, sky, {terms, terms, terms});
        const float whole = triple.onGrid(basis, lobes, p.frame, p.eye, masks.data()).y;
        const float off =
            std::abs(
                triple.light(triple.visibility(masks.data()), triple.reflectance(basis.lobes[5], p.frame, p.eye)).y -
                whole) /
            whole;
        EXPECT_LE(off, before);
        before = std::max(off, 1e-5f);
    }
    EXPECT_LT(before, 1e-4f);
}

TEST(LiveGlossTaps, MeetTheSumOverEveryCellOfTheEnvironment) {
    const LiveGrid grid(32);
    const BrdfBasis basis = builtInBasis();
    const Point p;
    const std::vector<uint8_t> masks = halfHidden(grid, p.normal);
    for (const bool sun : {false, true}) {
        const DistantLight sky = skyOf(256, sun);
        const EnvironmentPyramid pyramid(sky);
        EXPECT_EQ(pyramid.suns().count > 0, sun);
        for (const std::vector<LobeWeight>& lobes :
             {std::vector<LobeWeight>{{4, Rgb(1)}}, std::vector<LobeWeight>{{9, Rgb(1, 0.5f, 0.2f)}},
              std::vector<LobeWeight>{{2, Rgb(0.5f)}, {11, Rgb(0.3f, 0.2f, 0.1f)}}}) {
            const Rgb whole = everyCell(sky, basis, lobes, p, grid, masks);
            for (const auto& [taps, bound] : {std::pair(64, 0.03f), std::pair(256, 0.015f)}) {
                const Rgb tapped =
                    tapEnvironment(pyramid, basis, lobes, TapPattern(taps), p.frame, p.eye, grid, masks.data());
                for (int c = 0; c < 3; ++c)
                    EXPECT_NEAR(tapped[c], whole[c], bound * whole[c])
                        << taps << " taps, lobe " << int(lobes[0].lobe) << ", sun " << sun;
            }
        }
    }
}

TEST(LiveGlossTaps, ConstantLightGivesTheLobesOwnReflectance) {
    const LiveGrid grid(32);
    const DistantLight white(DirectionGrid{64}, std::vector<Rgb>(64 * 64, Rgb(2)));
    const EnvironmentPyramid pyramid(white);
    const BrdfBasis basis = builtInBasis();
    const std::vector<uint8_t> open(grid.nibbleBytes(), 0xff);
    const std::vector<LobeWeight> lobes{{3, Rgb(1)}};
    // Straight from above a metal lobe of this width sends back nearly all light.
    const Rgb light = tapEnvironment(pyramid, basis, lobes, TapPattern(256), Mat3(1), Vec3(0, 0, 1), grid, open.data());
    EXPECT_NEAR(light.x, 2, 0.03f);
    EXPECT_EQ(light.x, light.y);
}

/// A glossy floor.
std::unique_ptr<LiveScene> glossyFloor(Progress& progress, std::shared_ptr<const Scene>& scene) {
    scene = std::make_shared<const Scene>(test::sceneOf(test::sheet({-2, -2, 0}, {4, 0, 0}, {0, 4, 0}, 30, 30)));
    auto estimate = std::make_shared<Estimate>(test::matteEstimate(*scene, Rgb(0.2f), Rgb(1)));
    const DistantLight sky = skyOf(256, true);
    estimate->environmentSide = 256;
    estimate->environment = sky.cells();
    estimate->reflectance.basis = builtInBasis();
    estimate->reflectance.weight.resize(13, std::vector<Rgb>(scene->mesh.vertexCount(), Rgb(0)));
    estimate->reflectance.weight[4].assign(scene->mesh.vertexCount(), Rgb(0.7f));
    return std::make_unique<LiveScene>(scene, estimate, LiveOptions{}, progress);
}

TEST(LiveGloss, OnlyTheImageIsShadedAndWhatComesIntoItFollows) {
    Progress progress;
    std::shared_ptr<const Scene> scene;
    const auto live = glossyFloor(progress, scene), whole = glossyFloor(progress, scene);
    const Vec3 from(0, -3, 2);
    const auto aimed = [&](const Vec3& at) { return Eye{from, glm::normalize(at - from), false, 0.2f}; };
    whole->setEye({from, Vec3(0, 1, 0), false});
    while (!whole->refine(1, progress)) {}
    live->setEye(aimed({-1, 0, 0}));
    while (!live->refine(1, progress)) {}
    EXPECT_GT(live->frame()->report.glossyOutside, 500u);
    EXPECT_EQ(live->frame()->report.leftOut.empty(), false);
    live->setEye(aimed({1, 0, 0}));
    live->refine(0, progress);
    EXPECT_LT(live->frame()->report.glossyVertices, 300u);
    while (!live->refine(1, progress)) {}
    size_t inside = 0;
    for (size_t v = 0; v < scene->mesh.vertexCount(); ++v) {
        const Vec3 to = glm::normalize(scene->mesh.positions[v] - from);
        if (glm::dot(to, glm::normalize(Vec3(1, 0, 0) - from)) < std::cos(0.2f)) continue;
        ++inside;
        EXPECT_EQ(live->frame()->radiance[v], whole->frame()->radiance[v]);
    }
    EXPECT_GT(inside, 20u);
    // Seen from elsewhere, everything is taken again.
    live->setEye({Vec3(0, -3, 2.5f), Vec3(0, 1, 0), false});
    live->refine(0, progress);
    EXPECT_EQ(live->frame()->report.glossyVertices, scene->mesh.vertexCount());
    EXPECT_EQ(live->frame()->report.glossyOutside, 0u);
}

double relativeRms(const std::vector<Rgb>& a, const std::vector<Rgb>& b, size_t count) {
    double difference = 0, sum = 0;
    for (size_t v = 0; v < count; ++v) {
        difference += double(glm::dot(a[v] - b[v], a[v] - b[v]));
        sum += double(glm::dot(b[v], b[v]));
    }
    return std::sqrt(difference / sum);
}

TEST(LiveGloss, WhatStaysWhileAnEmitterIsDraggedIsRightAtRest) {
    Mesh mesh = test::sheet({-2, -2, 0}, {4, 0, 0}, {0, 4, 0}, 30, 30);
    const size_t floor = mesh.vertexCount();
    const std::vector<uint32_t> one = test::append(mesh, test::squareAbove(0.6f, 0.9f, 0.5f, 2, 2)),
                                two = test::append(mesh, test::squareAbove(0.5f, -0.9f, -0.5f, 1.5f, 2));
    const auto scene = std::make_shared<const Scene>(test::sceneOf(mesh));
    auto estimate = std::make_shared<Estimate>(
        test::matteEstimate(*scene, Rgb(0.2f), Rgb(1), test::emittersOf(*scene, {one, two}, {Rgb(9), Rgb(6)})));
    estimate->environmentSide = 256;
    estimate->environment = skyOf(256, true).cells();
    estimate->reflectance.basis = builtInBasis();
    estimate->reflectance.weight.resize(13, std::vector<Rgb>(mesh.vertexCount(), Rgb(0)));
    std::fill_n(estimate->reflectance.weight[3].begin(), floor, Rgb(0.7f));
    const Eye eye{Vec3(0, -3, 2), Vec3(0, 1, 0), false};
    Progress progress;
    const auto lookAt = [](const Vec3& by) {
        Look look;
        look.emitters.push_back({"emitter-1", true, test::translation(by), Rgb(1)});
        return look;
    };
    LiveScene dragged(scene, estimate, {}, progress), direct(scene, estimate, {}, progress);
    dragged.setEye(eye);
    direct.setEye(eye);
    while (!dragged.refine(1, progress)) {}
    dragged.setLook(lookAt({-0.5f, 0.3f, 0}));
    dragged.refine(0, progress);
    dragged.setLook(lookAt({-0.9f, 0.1f, -0.4f}));  // two edits before the next image
    dragged.setLook(lookAt({-1.2f, -0.8f, -0.9f}));
    dragged.refine(0, progress);
    const auto first = dragged.frame();
    while (!dragged.refine(1, progress)) {}
    direct.setLook(lookAt({-1.2f, -0.8f, -0.9f}));
    while (!direct.refine(1, progress)) {}
    EXPECT_LT(relativeRms(dragged.frame()->radiance, direct.frame()->radiance, floor), 2e-3);
    EXPECT_LT(relativeRms(first->radiance, direct.frame()->radiance, floor), 0.06);
}

TEST(LiveGloss, SameBitsOnAnyNumberOfThreads) {
    std::vector<Rgb> one;
    for (const int threads : {1, 0}) {
        const ThreadLimit limit(threads);
        Progress progress;
        std::shared_ptr<const Scene> scene;
        const auto live = glossyFloor(progress, scene);
        live->setEye({Vec3(0, -3, 2), Vec3(0, 1, 0), false, 0.4f});
        live->refine(0, progress);
        if (one.empty()) one = live->frame()->radiance;
        else EXPECT_EQ(one, live->frame()->radiance);
    }
}

}  // namespace
}  // namespace relamp
