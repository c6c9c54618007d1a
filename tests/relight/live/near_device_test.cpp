// Near fields on a device: the image is the same with one, without one, and with one that fails at any call.
#include "relight/live/near_device.h"

#include <gtest/gtest.h>

#include <deque>

#include "base/error.h"
#include "base/log.h"
#include "base/random.h"
#include "support/device_world.h"

namespace relamp {
namespace {

/// Computes on the processor, under another name, and fails from the call `failsAt` on.
class TestNear : public NearDevice {
public:
    int calls = 0, vertices = 0, failsAt = 1 << 30;
    float factor = 1;
    bool cleared = false;
    std::string name() const override { return "test device"; }
    void start(const NearQuery& q) override {
        count();
        std::vector<NearAnswer> answers;
        for (const uint32_t v : q.wanted) {
            const Vec3 point = q.vertices.mesh->positions[v], to = q.emitter.centre - point;
            const bool close = q.level < 3 && glm::dot(to, to) < 6.25f * q.emitter.radius * q.emitter.radius;
            NearAnswer a;
            a.factor = factor * nearFactor(q.emitter, q.occluders, point, q.vertices.mesh->normals[v],
                                           q.level == 1 ? coarseCut : fineCut, nearSamples(q.level) * (close ? 2 : 1),
                                           mixBits(mixBits(q.seed + q.emitter.part) ^ v), a.open);
            answers.push_back(a);
        }
        vertices += int(answers.size());
        started_.push_back(std::move(answers));
    }
    void finish(std::span<NearAnswer> out) override {
        count();
        ASSERT_FALSE(started_.empty());
        ASSERT_EQ(started_.front().size(), out.size());
        std::copy(started_.front().begin(), started_.front().end(), out.begin());
        started_.pop_front();
    }
    void forget() override { started_.clear(); }
    void clear() override { cleared = true; }

private:
    std::deque<std::vector<NearAnswer>> started_;
    void count() {
        if (++calls >= failsAt) throw Error("the test pulled the plug");
    }
};

using Shown = test::DeviceShown;

Shown showNear(const std::shared_ptr<NearDevice>& device, bool force = true, bool emitters = true) {
    const test::DeviceWorld world(emitters ? std::vector<float>{0.4f, 0.1f} : std::vector<float>{});
    LiveOptions options;
    options.devices.near = device;
    options.forceDevice = force;
    return test::showWith(world, options, [&](LiveScene& live, Shown& shown, Progress& progress) {
        Look look;
        if (emitters) look.emitters.push_back({world.estimate->emitters.emitters[0].id, true, Mat4(1), Rgb(1)});
        for (const float x : {-0.5f, -1.0f}) {
            if (emitters) look.emitters[0].matrix = test::translation({x, 0, 0});
            live.setLook(look);
            live.refine(0, progress);
            shown.coarse = live.frame()->radiance;
            while (!live.refine(1, progress)) {}
        }
    });
}

float difference(const std::vector<Rgb>& a, const std::vector<Rgb>& b) {
    double off = 0, sum = 0;
    for (size_t v = 0; v < a.size(); ++v) {
        off += double(glm::length(a[v] - b[v]));
        sum += double(glm::length(a[v]));
    }
    return float(off / sum);
}

TEST(LiveNearDevice, ShowsTheSameImageAsTheProcessor) {
    const auto device = std::make_shared<TestNear>();
    const Shown without = showNear(nullptr), with = showNear(device);
    // In the first image the processor takes what the baked masks know in place of rays at the ground.
    EXPECT_LT(difference(without.coarse, with.coarse), 2e-3f);
    EXPECT_LT(difference(without.radiance, with.radiance), 2e-3f);
    EXPECT_EQ(with.report.nearDevice, "test device");
    EXPECT_GT(with.report.deviceNearMs, 0);
    EXPECT_GT(with.report.cpuNearMs, 0);
    EXPECT_EQ(with.warnings, 0u);
    EXPECT_GT(device->vertices, 4 * 700) << "coarse and fine samples of both images";
    EXPECT_EQ(without.report.nearDevice, "");
    EXPECT_EQ(without.report.deviceNearMs, 0);
    EXPECT_EQ(with.radiance, showNear(std::make_shared<TestNear>()).radiance);
}

TEST(LiveNearDevice, ADeviceThatFailsLosesNothingAndIsNotAskedAgain) {
    const auto whole = std::make_shared<TestNear>();
    const Shown without = showNear(nullptr), with = showNear(whole);
    for (const int failsAt : {1, 2, 4, 5, 6, 7, 8, 11, 14, whole->calls - 1, whole->calls}) {
        const auto device = std::make_shared<TestNear>();
        device->failsAt = failsAt;
        const Shown shown = showNear(device);
        EXPECT_LT(difference(without.radiance, shown.radiance), 2e-3f) << failsAt;
        EXPECT_TRUE(failsAt > 4 || shown.radiance == without.radiance) << failsAt;
        EXPECT_EQ(shown.report.nearDevice, "") << failsAt;
        EXPECT_EQ(shown.warnings, 1u) << failsAt;
        EXPECT_EQ(device->calls, failsAt);
        EXPECT_EQ(showNear(device).radiance, without.radiance);
        EXPECT_EQ(device->calls, failsAt) << "another scene asks it again";
    }
}

TEST(LiveNearDevice, AStoppedStartIsForgotten) {
    const Mesh mesh = test::sheet({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, 4, 4), square = test::squareAbove(0.4f, 0, 0, 1);
    EditedGeometry geometry;
    geometry.mesh = mesh;
    geometry.partOfTriangle.assign(mesh.triangles.size(), 0);
    LiveOccluders occluders;
    occluders.ground = tracerOf(geometry, 0);
    DeviceBlockers blockers;
    blockers.follow(occluders, mesh, geometry.partOfTriangle);
    LiveVertices vertices;
    vertices.mesh = std::make_shared<const Mesh>(mesh);
    vertices.kind.assign(mesh.vertexCount(), LiveVertices::ground);
    std::vector<NearEmitter> emitters(1);
    EmitterCluster all;
    for (uint32_t t = 0; t < square.triangles.size(); ++t) all.triangles.push_back(t);
    const auto put = [&](float x) {
        emitters[0].tree = LiveEmitterTree(emitterSurface(square, all, test::translation({x, 0, 0})));
        emitters[0].centre = emitters[0].tree.surface().centroid;
        emitters[0].radius = emitters[0].tree.surface().radius;
        for (auto* values : {&emitters[0].factor, &emitters[0].open}) values->assign(vertices.count(), 0);
        emitters[0].level.assign(vertices.count(), 0);
    };
    put(0);
    Progress progress;
    NearPlace place;
    const auto device = std::make_shared<TestNear>();
    place.choose(&emitters[0], vertices, occluders, blockers, device, true, 1, progress);
    ASSERT_TRUE(place.used());
    place.start(emitters, vertices, occluders, blockers, 1);  // and stopped here
    put(0.5f);
    place.start(emitters, vertices, occluders, blockers, 1);
    place.finish(emitters);
    for (uint32_t v = 0; v < vertices.count(); ++v) {
        float open = 0;
        EXPECT_EQ(emitters[0].level[v], 1);
        EXPECT_EQ(emitters[0].factor[v], nearFactor(emitters[0], occluders, mesh.positions[v], mesh.normals[v],
                                                    coarseCut, 4, mixBits(mixBits(1) ^ v), open));
    }
}

TEST(LiveNearDevice, ADeviceThatAnswersWronglyIsRefused) {
    const Shown without = showNear(nullptr);
    for (const float factor : {1.05f, 0.0f, std::numeric_limits<float>::quiet_NaN()}) {
        const auto device = std::make_shared<TestNear>();
        device->factor = factor;
        const Shown shown = showNear(device);
        EXPECT_EQ(shown.radiance, without.radiance);
        EXPECT_EQ(shown.report.nearDevice, "");
        EXPECT_EQ(shown.warnings, 1u);
    }
}

TEST(LiveNearDevice, TheFasterOneIsUsedUnlessForcedAlsoWithoutAnEmitter) {
    for (const bool emitters : {true, false}) {
        const auto device = std::make_shared<TestNear>();
        const Shown shown = showNear(device, false, emitters);
        EXPECT_GT(shown.report.deviceNearMs, 0);
        EXPECT_EQ(shown.report.nearDevice.empty(), shown.report.deviceNearMs >= shown.report.cpuNearMs);
        EXPECT_EQ(device->cleared, shown.report.nearDevice.empty()) << "a device that lost frees its memory";
        EXPECT_EQ(shown.warnings, 0u);
    }
}

}  // namespace
}  // namespace relamp
