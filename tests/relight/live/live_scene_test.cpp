#include "relight/live/live_scene.h"

#include <gtest/gtest.h>

#include "base/parallel.h"
#include "base/random.h"
#include "image/image_io.h"
#include "support/estimates.h"
#include "support/temporary_folder.h"
#include "transport/near_field.h"

namespace relamp {
namespace {

/// A floor, a box standing on it, a panel in the air and a square emitter above; light from everywhere, more from one
/// side.
struct World {
    std::shared_ptr<const Scene> scene;
    std::shared_ptr<Estimate> estimate;
    uint32_t boxVertex = 0, panelVertex = 0;
};

Rgb skyTowards(const Vec3& d) {
    return Rgb(0.5f) + Rgb(0.6f, 0.4f, 0.2f) * std::max(0.0f, glm::dot(d, glm::normalize(Vec3(1, 0.3f, 0.8f))));
}

World world(int cuts = 20) {
    World w;
    Mesh mesh = test::sheet({-2, -2, 0}, {4, 0, 0}, {0, 4, 0}, cuts, cuts);
    w.boxVertex = uint32_t(mesh.vertexCount());
    test::append(mesh, test::box({-0.4f, -0.4f, 0.01f}, {0.4f, 0.4f, 0.8f}, 4));
    w.panelVertex = uint32_t(mesh.vertexCount());
    test::append(mesh, test::sheet({0.6f, -1, 1.1f}, {0.8f, 0, 0.1f}, {0, 0.8f, 0}, 4, 4));
    const std::vector<uint32_t> emitter = test::append(mesh, test::squareAbove(0.4f, 0.9f, 0.5f, 2, 2));
    w.scene = std::make_shared<const Scene>(test::sceneOf(mesh));
    w.estimate = std::make_shared<Estimate>(test::matteEstimate(
        *w.scene, Rgb(0.5f, 0.4f, 0.3f), Rgb(1), test::emittersOf(*w.scene, {emitter}, {Rgb(20, 24, 30)})));
    const DirectionGrid grid{w.estimate->environmentSide};
    for (int c = 0; c < grid.cells(); ++c) w.estimate->environment[size_t(c)] = skyTowards(grid.direction(c));
    return w;
}

LiveOptions precise() {
    LiveOptions options;
    options.error = 0.002f;
    return options;
}

std::shared_ptr<const LiveFrame> refined(LiveScene& live) {
    Progress progress;
    while (!live.refine(1, progress)) {}
    return live.frame();
}

/// Radiance of the capture's vertices by brute force: many rays from each, through the scene that a final frame would
/// use.
std::vector<Rgb> reference(const World& w, const Look& look) {
    const RelitScene relit = test::relitOf(*w.scene, *w.estimate, look);
    const Mesh& mesh = relit.scene.mesh;
    std::vector<uint8_t> shines(mesh.vertexCount(), 0);
    std::vector<Rgb> out(mesh.vertexCount(), Rgb(0));
    for (size_t t = 0; t < mesh.triangles.size(); ++t)
        if (const int e = relit.emitterOfTriangle[t]; e >= 0)
            for (uint32_t v : mesh.triangles[t]) {
                shines[v] = 1;
                out[v] = relit.emitters[size_t(e)].emission.level;
            }
    parallelFor(mesh.vertexCount(), 16, [&](size_t v) {
        if (shines[v]) return;
        constexpr uint32_t rays = 4096;
        const Mat3 frame = frameAround(mesh.normals[v]);
        const Vec3 origin = rayOrigin(relit.scene, mesh.positions[v], mesh.normals[v]);
        Rgb light(0);
        for (uint32_t i = 0; i < rays; ++i) {
            const Vec3 d = frame * cosineHemisphere(r2Point(i, randomShift(7, v, 0)));
            if (!relit.scene.tracer->occluded({origin, d, 0, 1e30f})) light += relit.distant->radiance(d) / float(rays);
        }
        std::vector<EmitterSample> samples;
        for (const RelitEmitter& e : relit.emitters) {
            sampleEmitter(relit.scene, e.surface, mesh.positions[v], mesh.normals[v], 1024, v, samples);
            for (const EmitterSample& s : samples) light += s.formFactor * s.visible * e.emission.level;
        }
        out[v] = relit.weight[0][v] * light;
    });
    out.resize(w.scene->mesh.vertexCount());
    return out;
}

double relativeRms(const std::vector<Rgb>& a, const std::vector<Rgb>& b) {
    double difference = 0, sum = 0;
    for (size_t v = 0; v < std::min(a.size(), b.size()); ++v) {
        difference += double(glm::dot(a[v] - b[v], a[v] - b[v]));
        sum += double(glm::dot(b[v], b[v]));
    }
    return std::sqrt(difference / sum);
}

/// The same of what is neither emitter in `frame`: emitters are much brighter and would hide everything.
double litRms(const LiveFrame& frame, const std::vector<Rgb>& expected) {
    std::vector<Rgb> a, b;
    std::vector<uint8_t> shines(frame.radiance.size(), 0);
    for (size_t t = 0; t < frame.emitterOfTriangle->size(); ++t)
        if ((*frame.emitterOfTriangle)[t] >= 0)
            for (uint32_t v : frame.mesh->triangles[t]) shines[v] = 1;
    for (size_t v = 0; v < std::min(frame.radiance.size(), expected.size()); ++v)
        if (!shines[v]) {
            a.push_back(frame.radiance[v]);
            b.push_back(expected[v]);
        }
    return relativeRms(a, b);
}

Mat4 turnedAndMoved(float angle, const Vec3& by) {
    Mat4 m = test::translation(by);
    m[0] = Vec4(std::cos(angle), std::sin(angle), 0, 0);
    m[1] = Vec4(-std::sin(angle), std::cos(angle), 0, 0);
    return m;
}

Look emitterMoved() {
    Look look;
    look.emitters.push_back({"emitter-1", true, test::translation({-1.2f, -0.8f, -0.3f}), Rgb(0.5f, 1, 1)});
    return look;
}

Look boxMoved(const World& w) {
    Look look;
    look.parts.push_back({w.boxVertex, turnedAndMoved(0.4f, {-0.6f, 0.3f, 0.2f})});
    return look;
}

Look sphereAdded() {
    Look look;
    look.added.push_back({EmitterShape::sphere, "bulb", test::translation({-1, 0.8f, 0.6f}), Vec2(0.3f), Rgb(8, 6, 4)});
    return look;
}

TEST(LiveScene, ConstantLightOnAnOpenPlaneGivesItsAlbedo) {
    const auto scene =
        std::make_shared<const Scene>(test::sceneOf(test::sheet({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, 6, 6)));
    const auto estimate =
        std::make_shared<const Estimate>(test::matteEstimate(*scene, Rgb(0.25f, 0.5f, 0.75f), Rgb(1)));
    Progress progress;
    LiveScene live(scene, estimate, {}, progress);
    const auto frame = refined(live);
    for (size_t v = 0; v < scene->mesh.vertexCount(); ++v)
        for (int k = 0; k < 3; ++k) {
            EXPECT_NEAR(frame->distantMatte[v][k], 1, 1e-3);
            EXPECT_NEAR(frame->radiance[v][k], 0.25 * (k + 1), 1e-3);
        }
    EXPECT_EQ(frame->report.leftOut.size(), 4u) << "no gloss, no bounces, no emitter, nothing that moves";
}

TEST(LiveScene, ADiskAboveAPlaneHasItsClosedFormFactor) {
    const auto scene =
        std::make_shared<const Scene>(test::sceneOf(test::sheet({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, 4, 4)));
    const auto estimate = std::make_shared<const Estimate>(test::matteEstimate(*scene, Rgb(1), Rgb(0)));
    Progress progress;
    LiveScene live(scene, estimate, {}, progress);
    Look look;
    look.added.push_back({EmitterShape::disk, "disk", test::translation({0, 0, 1.5f}), Vec2(1), Rgb(2)});
    live.setLook(look);
    const auto frame = refined(live);
    for (size_t v = 0; v < scene->mesh.vertexCount(); ++v) {
        const double h = 1.5, r = 0.5, a = glm::length(Vec2(scene->mesh.positions[v]));
        // Howell's catalogue, B-12: a small plane parallel to a disk, off its axis.
        const double z = 1 + (h / a) * (h / a) + (r / a) * (r / a);
        const double expected = a > 0
                                    ? 0.5 * (1 - (z - 2 * (r / a) * (r / a)) / std::sqrt(z * z - 4 * (r / a) * (r / a)))
                                    : r * r / (h * h + r * r);
        EXPECT_NEAR(frame->formFactor[0][v], expected, 0.01 * expected);
        EXPECT_NEAR(frame->radiance[v].x, 2 * expected, 0.02 * expected);
    }
}

TEST(LiveScene, AnEmitterThatShinesToOneSideIsBlackFromBehind) {
    const auto scene = std::make_shared<Scene>(test::sceneOf(test::sheet({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, 2, 2)));
    const auto estimate = std::make_shared<Estimate>(test::matteEstimate(*scene, Rgb(0.5f), Rgb(0)));
    Look look;
    look.added.push_back({EmitterShape::disk, "disk-1", test::translation({0, 0, 1}), Vec2(0.5f), Rgb(4)});
    look.added.push_back({EmitterShape::sphere, "ball-1", test::translation({2, 0, 1}), Vec2(0.5f), Rgb(7)});
    Progress progress;
    LiveScene live(scene, estimate, {}, progress);
    live.setLook(look);
    const auto shownFrom = [&](const Vec3& place) {
        live.setEye({place, glm::normalize(Vec3(0, 0, 1) - place)});
        const auto frame = refined(live);
        std::array<float, 2> brightest{0, 0};
        for (size_t t = 0; t < frame->mesh->triangles.size(); ++t)
            if (const int e = (*frame->emitterOfTriangle)[t]; e >= 0)
                for (const uint32_t v : frame->mesh->triangles[t])
                    brightest[size_t(e)] = std::max(brightest[size_t(e)], frame->radiance[v].x);
        return brightest;
    };
    EXPECT_EQ(shownFrom({0.2f, 0.1f, 0.3f}), (std::array<float, 2>{4, 7})) << "it faces down";
    EXPECT_EQ(shownFrom({0.2f, 0.1f, 3}), (std::array<float, 2>{0, 7}));
}

TEST(LiveScene, AgreesWithBruteForceBeforeAndAfterEdits) {
    const World w = world();
    Progress progress;
    LiveScene live(w.scene, w.estimate, precise(), progress);
    EXPECT_LT(litRms(*refined(live), reference(w, {})), 0.01);
    const test::TemporaryFolder folder;
    Image map(128, 64);
    for (int y = 0; y < 64; ++y)
        for (int x = 0; x < 128; ++x)
            map.at(x, y) = Rgb(0.2f + 0.8f * float(y < 20), 0.3f, 0.2f + 0.5f * float(x) / 128);
    writeImage(folder / "sky.exr", map);
    Look sky;
    sky.environment.source = EnvironmentLook::Source::file;
    sky.environment.file = folder / "sky.exr";
    sky.environment.yawDegrees = 70;
    sky.environment.exposureStops = 1;
    sky.environment.tint = Rgb(1, 0.8f, 0.6f);
    Look all = boxMoved(w);
    all.environment = sky.environment;
    all.emitters = emitterMoved().emitters;
    all.added = sphereAdded().added;
    for (const auto& [name, look] :
         {std::pair{"light moved", emitterMoved()}, std::pair{"sphere added", sphereAdded()},
          std::pair{"other environment", sky}, std::pair{"box moved", boxMoved(w)}, std::pair{"all of it", all}}) {
        live.setLook(look);
        EXPECT_FALSE(live.refine(0, progress)) << name;
        const auto coarse = live.frame();
        EXPECT_LT(litRms(*coarse, reference(w, look)), 0.06) << name << ": the first image is whole";
        EXPECT_LT(litRms(*refined(live), reference(w, look)), 0.01) << name;
    }
}

TEST(LiveScene, AChainOfEditsEndsWhereAFreshSceneStarts) {
    const World w = world();
    Progress progress;
    LiveScene live(w.scene, w.estimate, precise(), progress);
    const auto original = refined(live);
    Look last = boxMoved(w);
    last.emitters = emitterMoved().emitters;
    last.added = sphereAdded().added;
    for (const Look& look : {emitterMoved(), sphereAdded(), boxMoved(w), last}) {
        live.setLook(look);
        live.refine(0.002, progress);
    }
    LiveScene fresh(w.scene, w.estimate, precise(), progress);
    fresh.setLook(last);
    EXPECT_LT(relativeRms(refined(live)->radiance, refined(fresh)->radiance), 1e-3);
    live.setLook({});
    const auto back = refined(live);
    EXPECT_LT(litRms(*back, original->radiance), 2e-3);
    EXPECT_EQ(back->emitterIds, original->emitterIds);
}

TEST(LiveScene, MovingAnEmitterThereAndBackGivesTheSameBits) {
    const World w = world();
    Progress progress;
    LiveScene live(w.scene, w.estimate, {}, progress);
    const auto original = refined(live);
    live.setLook(emitterMoved());
    refined(live);
    live.setLook({});
    EXPECT_EQ(refined(live)->radiance, original->radiance);
}

TEST(LiveScene, GivesTheSameBitsOnAnyNumberOfThreads) {
    const World w = world(8);
    Look look = boxMoved(w);
    look.emitters = emitterMoved().emitters;
    std::vector<std::vector<Rgb>> images;
    for (const int threads : {1, 4}) {
        const ThreadLimit limit(threads);
        Progress progress;
        LiveScene live(w.scene, w.estimate, {}, progress);
        live.setLook(look);
        live.refine(0, progress);
        images.push_back(live.frame()->radiance);
        images.push_back(refined(live)->radiance);
    }
    EXPECT_EQ(images[0], images[2]);
    EXPECT_EQ(images[1], images[3]);
}

TEST(LiveScene, GoesOnAfterItWasStopped) {
    const World w = world(8);
    Progress progress;
    LiveScene live(w.scene, w.estimate, {}, progress), other(w.scene, w.estimate, {}, progress);
    const auto before = refined(live);
    refined(other);
    live.setLook(boxMoved(w));
    Progress stopped;
    stopped.requestStop();
    EXPECT_THROW(live.refine(1, stopped), Cancelled);
    EXPECT_EQ(live.frame(), before) << "the old image stays";
    other.setLook(boxMoved(w));
    EXPECT_EQ(refined(live)->radiance, refined(other)->radiance);
}

TEST(LiveScene, ABadLookLeavesItAsItWas) {
    const World w = world(8);
    Progress progress;
    LiveScene live(w.scene, w.estimate, {}, progress);
    const auto before = refined(live);
    Look unknown, outside, noFile;
    unknown.emitters.push_back({"emitter-7", true, Mat4(1), Rgb(1)});
    outside.parts.push_back({1u << 30, Mat4(1)});
    noFile.environment.source = EnvironmentLook::Source::file;
    noFile.environment.file = "/nowhere/sky.exr";
    for (const Look& look : {unknown, outside, noFile}) EXPECT_THROW(live.setLook(look), Error);
    EXPECT_TRUE(live.refine(1, progress)) << "nothing to do";
    EXPECT_EQ(live.frame(), before);
}

TEST(LiveScene, PowerAndExposureScaleWhatIsKnown) {
    const World w = world(8);
    Progress progress;
    LiveScene live(w.scene, w.estimate, {}, progress);
    const auto before = refined(live);
    Look look;
    look.emitters.push_back({"emitter-1", true, Mat4(1), Rgb(2, 0, 1)});
    look.environment.exposureStops = 1;
    live.setLook(look);
    EXPECT_TRUE(live.refine(1, progress)) << "one slice is enough";
    const auto after = live.frame();
    EXPECT_EQ(after->formFactor, before->formFactor);
    EXPECT_EQ(after->mesh, before->mesh) << "geometry did not change";
    for (size_t v = 0; v < 81; ++v)
        EXPECT_NEAR(after->radiance[v].x, 0.5f * 2 * (before->distantMatte[v].x + before->formFactor[0][v] * 20), 1e-4);
    look.emitters[0].enabled = false;
    live.setLook(look);
    live.refine(0, progress);
    EXPECT_EQ(live.frame()->emitterRadiance[0], Rgb(0));
    for (size_t v = 0; v < 81; ++v)
        EXPECT_NEAR(live.frame()->radiance[v].x, 0.5f * 2 * before->distantMatte[v].x, 1e-4);
}

TEST(LiveScene, APartThatShinesLightsTheRest) {
    const World w = world(10);
    Progress progress;
    LiveScene live(w.scene, w.estimate, precise(), progress);
    refined(live);
    AddedEmitter glow;
    glow.shape = EmitterShape::part;
    glow.id = "glow";
    glow.seedVertex = w.panelVertex;
    glow.radiance = Rgb(5);
    Look look;
    look.added.push_back(glow);
    live.setLook(look);
    EXPECT_LT(litRms(*refined(live), reference(w, look)), 0.01);
    look.added[0].matrix = test::translation({-1, 0, -0.2f});
    live.setLook(look);
    EXPECT_LT(litRms(*refined(live), reference(w, look)), 0.01);
    live.setLook({});
    EXPECT_LT(litRms(*refined(live), reference(w, {})), 0.01) << "and is a plain surface again";
}

/// A ball of two glossy lobes over a floor under the sky, an emitter beside it.
World glossyWorld() {
    World w;
    Mesh mesh = test::sheet({-2, -2, 0}, {4, 0, 0}, {0, 4, 0}, 4, 4);
    const uint32_t first = uint32_t(mesh.vertexCount());
    test::append(mesh, test::ball({0, 0, 0.8f}, 0.5f, 24, 48));
    const uint32_t last = uint32_t(mesh.vertexCount());
    const std::vector<uint32_t> emitter = test::append(mesh, test::squareAbove(0.8f, 0.2f, -0.6f, 2, 4));
    w.scene = std::make_shared<const Scene>(test::sceneOf(mesh));
    w.estimate = std::make_shared<Estimate>(
        test::matteEstimate(*w.scene, Rgb(0), Rgb(1), test::emittersOf(*w.scene, {emitter}, {Rgb(10, 12, 15)})));
    const DirectionGrid grid{w.estimate->environmentSide};
    for (int c = 0; c < grid.cells(); ++c) w.estimate->environment[size_t(c)] = skyTowards(grid.direction(c));
    Reflectance& r = w.estimate->reflectance;
    r.basis.lobes.push_back({Lobe::Kind::ggx, 0.08f, "narrow"});
    r.basis.lobes.push_back({Lobe::Kind::ggxDielectric, 0.3f, "wide"});
    r.weight.assign(3, std::vector<Rgb>(mesh.vertexCount(), Rgb(0)));
    for (uint32_t v = first; v < last; ++v) {
        r.weight[1][v] = Rgb(0.7f, 0.6f, 0.5f);
        r.weight[2][v] = Rgb(0.8f);
    }
    return w;
}

/// What the lobes of each vertex send to the eye, by rays drawn from them.
std::vector<Rgb> glossyReference(const World& w, const Look& look, const Vec3& eye) {
    const RelitScene relit = test::relitOf(*w.scene, *w.estimate, look);
    const Mesh& mesh = relit.scene.mesh;
    std::vector<Rgb> out(w.scene->mesh.vertexCount(), Rgb(0));
    parallelFor(out.size(), 4, [&](size_t v) {
        if (!(maxChannel(relit.weight[1][v]) > 0) ||
            !(glm::dot(eye - mesh.positions[v], mesh.normals[v]) > 1e-3f * glm::length(eye - mesh.positions[v])))
            return;
        const Mat3 frame = frameAround(mesh.normals[v]);
        const Vec3 toEye = glm::transpose(frame) * glm::normalize(eye - mesh.positions[v]),
                   origin = rayOrigin(relit.scene, mesh.positions[v], mesh.normals[v]);
        constexpr int rays = 4096;
        for (size_t k = 1; k < 3; ++k)
            for (uint32_t i = 0; i < rays; ++i) {
                const float alpha = relit.basis.lobes[k].alpha;
                const Vec3 local = sampleGgx(toEye, alpha, r2Point(i, randomShift(3, v, k))), d = frame * local;
                if (local.z <= 0) continue;
                const Hit hit = relit.scene.tracer->closest({origin, d, 0, 1e30f});
                Rgb light = relit.distant->radiance(d);
                if (hit) {
                    const int e = relit.emitterOfTriangle[hit.triangle];
                    light = e >= 0 && glm::dot(mesh.faceNormal(hit.triangle), d) < 0
                                ? relit.emitters[size_t(e)].emission.level
                                : Rgb(0);
                }
                out[v] += relit.weight[k][v] * light * evaluateLobe(relit.basis.lobes[k], local, toEye) * local.z /
                          (ggxSampleDensity(local, toEye, alpha) * rays);
            }
    });
    return out;
}

TEST(LiveScene, GlossShowsSkyAndEmittersAsBruteForceDoes) {
    const World w = glossyWorld();
    Progress progress;
    LiveScene live(w.scene, w.estimate, {}, progress);
    const Vec3 eye(1.5f, -3, 2);
    live.setEye({eye, glm::normalize(Vec3(0, 0, 0.8f) - eye), false});
    EXPECT_FALSE(live.refine(0, progress));
    EXPECT_LT(litRms(*live.frame(), glossyReference(w, {}, eye)), 0.04);
    EXPECT_LT(litRms(*refined(live), glossyReference(w, {}, eye)), 0.01);
    EXPECT_GT(live.frame()->report.glossyVertices, 300u);
    const Look moved = emitterMoved();
    live.setLook(moved);
    EXPECT_LT(litRms(*refined(live), glossyReference(w, moved, eye)), 0.01);
    const Vec3 other(-2, -2, 1.5f);
    live.setEye({other, glm::normalize(Vec3(0, 0, 0.8f) - other), false});
    EXPECT_LT(litRms(*refined(live), glossyReference(w, moved, other)), 0.01) << "seen from elsewhere";
}

TEST(LiveScene, LightAtAPointAddsUpToItsRadiance) {
    const World w = world(8);
    Progress progress;
    LiveScene live(w.scene, w.estimate, {}, progress);
    const auto frame = refined(live);
    const PointLight at = live.lightAt(40, Vec2(0.2f, 0.3f));
    const Triangle& t = frame->mesh->triangles[40];
    const Rgb expected = 0.5f * frame->radiance[t[0]] + 0.2f * frame->radiance[t[1]] + 0.3f * frame->radiance[t[2]];
    Rgb sum = at.fromEnvironment;
    for (const Rgb& e : at.fromEmitter) sum += e;
    EXPECT_LT(glm::length(sum - expected), 1e-5f);
    // What arrives, gathered over the square, is what leaves.
    Rgb gathered(0);
    for (int c = 0; c < at.grid.cells(); ++c)
        gathered += at.incident[size_t(c)] * std::max(0.0f, glm::dot(at.grid.direction(c), at.normal)) *
                    at.grid.cellSolidAngle() / pi;
    EXPECT_NEAR(gathered.x * at.weights[0].x, expected.x, 0.1f * expected.x);
}

}  // namespace
}  // namespace relamp
