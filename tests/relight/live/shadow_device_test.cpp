// Shadows of parts on a device: the image is the same with one, without one, and with one that fails at any call.
#include "relight/live/shadow_device.h"

#include <gtest/gtest.h>

#include <deque>

#include "base/error.h"
#include "base/log.h"
#include "support/device_world.h"

namespace relamp {
namespace {

/// Traces on the processor, under another name, and fails from the call `failsAt` on.
class TestShadow : public ShadowDevice {
public:
    int calls = 0, starts = 0, failsAt = 1 << 30;
    bool wrong = false, crowded = false;
    std::string name() const override { return "test device"; }
    void start(const ShadowQuery& q) override {
        count();
        ++starts;
        const size_t slots = q.vertexOfSlot.size(), chunks = (slots + ShadowQuery::run - 1) / ShadowQuery::run;
        const LivePart& part = q.occluders.parts[q.part];
        ShadowAnswers out;
        out.slot.assign(chunks * ShadowQuery::run, 0);
        for (size_t s = 0; s < chunks * ShadowQuery::run; ++s) {
            if (s % ShadowQuery::run == 0) out.first.push_back(uint32_t(out.entries.size()));
            if (s >= slots || q.vertexOfSlot[s] == EditedPart::none) continue;
            const Vec3 position = q.vertices.mesh->positions[q.vertexOfSlot[s]];
            Vec3 axis;
            float angle;
            part.cone(position, axis, angle);
            std::vector<uint16_t> entries;
            const bool whole = traceCone(
                q.grid, q.occluders.origin(position, q.normal[s]), q.normal[s], axis, angle,
                q.masks.subspan(s * q.grid.nibbleBytes(), q.grid.nibbleBytes()), true,
                [&](std::span<const Ray> rays) { return part.occluded8(rays); }, entries);
            if (wrong) entries.clear();
            out.slot[s] = uint32_t(entries.size()) | (whole ? ShadowAnswers::whole : 0);
            if (entries.size() % 2) entries.push_back(0);
            out.entries.insert(out.entries.end(), entries.begin(), entries.end());
        }
        if (crowded)
            for (size_t c = 0; c < chunks; c += 2) out.first[c] = ShadowAnswers::none;
        started_.push_back(std::move(out));
    }
    void finish(ShadowAnswers& out) override {
        count();
        ASSERT_FALSE(started_.empty());
        out = std::move(started_.front());
        started_.pop_front();
    }
    void forget() override { started_.clear(); }
    void clear() override { started_.clear(); }

private:
    std::deque<ShadowAnswers> started_;
    void count() {
        if (++calls >= failsAt) throw Error("the test pulled the plug");
    }
};

using Shown = test::DeviceShown;

Shown showShadow(const std::shared_ptr<ShadowDevice>& device, bool force = true) {
    const test::DeviceWorld world({0.4f, 0.1f});
    const auto& emitters = world.estimate->emitters.emitters;
    LiveOptions options;
    options.devices.shadows = device;
    options.forceDevice = force;
    return test::showWith(world, options, [&](LiveScene& live, Shown& shown, Progress& progress) {
        Look look;
        for (const PartLook& part : {PartLook{}, PartLook{0, test::translation({0, 0, 0.2f}), ""}}) {
            if (part.matrix != Mat4(1)) {
                look.parts.push_back(part);  // the box leaves the ground, which changes what the device holds
                look.parts[0].seedVertex = 25 * 25;
            }
            for (const float x : {-0.5f, -1.0f}) {
                look.emitters = {{emitters[0].id, true, test::translation({x, 0, 0}), Rgb(1)},
                                 {emitters[1].id, true, test::translation({0, x, 0}), Rgb(1)}};
                live.setLook(look);
                live.refine(0, progress);
                shown.coarse.insert(shown.coarse.end(), live.frame()->radiance.begin(), live.frame()->radiance.end());
            }
            while (!live.refine(1, progress)) {}
        }
    });
}

TEST(LiveShadowDevice, ShowsTheSameImageAsTheProcessor) {
    const Shown without = showShadow(nullptr);
    for (const bool crowded : {false, true}) {
        const auto device = std::make_shared<TestShadow>();
        device->crowded = crowded;
        const Shown with = showShadow(device);
        EXPECT_EQ(with.coarse, without.coarse) << crowded;
        EXPECT_EQ(with.radiance, without.radiance) << crowded;
        EXPECT_EQ(with.report.shadowDevice, "test device");
        EXPECT_GT(with.report.deviceShadowMs, 0);
        EXPECT_GT(with.report.cpuShadowMs, 0);
        EXPECT_EQ(with.warnings, 0u);
        EXPECT_GE(device->starts, 2 + 8) << "two to measure, then two emitters in four images";
    }
    EXPECT_EQ(without.report.shadowDevice, "");
    EXPECT_EQ(without.report.cpuShadowMs, 0);
}

TEST(LiveShadowDevice, ADeviceThatFailsLosesNothingAndIsNotAskedAgain) {
    const Shown without = showShadow(nullptr);
    for (const int failsAt : {1, 2, 4, 5, 6, 8}) {
        const auto device = std::make_shared<TestShadow>();
        device->failsAt = failsAt;
        const Shown shown = showShadow(device);
        EXPECT_EQ(shown.coarse, without.coarse) << failsAt;
        EXPECT_EQ(shown.radiance, without.radiance) << failsAt;
        EXPECT_EQ(shown.report.shadowDevice, "") << failsAt;
        EXPECT_EQ(shown.warnings, 1u) << failsAt;
        EXPECT_EQ(device->calls, failsAt);
        EXPECT_EQ(showShadow(device).radiance, without.radiance);
        EXPECT_EQ(device->calls, failsAt) << "another scene asks it again";
    }
}

TEST(LiveShadowDevice, OneThatAnswersWronglyIsRefusedAndASlowerOneLeftUnlessForced) {
    const Shown without = showShadow(nullptr);
    const auto wrong = std::make_shared<TestShadow>();
    wrong->wrong = true;
    const Shown refused = showShadow(wrong);
    EXPECT_EQ(refused.coarse, without.coarse);
    EXPECT_EQ(refused.report.shadowDevice, "");
    EXPECT_EQ(refused.warnings, 1u);
    const Shown chosen = showShadow(std::make_shared<TestShadow>(), false);
    EXPECT_EQ(chosen.report.shadowDevice.empty(), chosen.report.deviceShadowMs >= chosen.report.cpuShadowMs);
    EXPECT_EQ(chosen.radiance, without.radiance);
}

}  // namespace
}  // namespace relamp
