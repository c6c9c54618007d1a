// Light summed by a device: the image is the same with one, without one, and with one that fails.
#include <gtest/gtest.h>

#include "base/error.h"
#include "base/log.h"
#include "relight/live/live_scene.h"
#include "support/device_world.h"

namespace relamp {
namespace {

/// Sums on the processor, under another name, and fails from the call `failsAt` on, or while it takes a store.
class TestDevice : public TransportDevice {
public:
    int applies = 0, loads = 0, failsAt = 1 << 30, failsLoadAt = 1 << 30;
    float factor = 1;
    std::string name() const override { return "test device"; }
    void apply(const std::array<std::vector<float>, 3>& coefs, std::span<Rgb> out) override {
        std::fill(out.begin(), out.end(), Rgb(99));
        if (++applies >= failsAt) throw Error("the test pulled the plug");
        store_.apply(coefs, out);
        for (Rgb& c : out) c *= factor;
    }

protected:
    void take(const TransportStore& store) override {
        if (++loads >= failsLoadAt) throw Error("no room in the test");
        store_ = store;
    }

private:
    TransportStore store_;
};

using Shown = test::DeviceShown;

Shown show(const std::shared_ptr<TransportDevice>& device, bool force = true) {
    LiveOptions options;
    options.devices.sums = device;
    options.forceDevice = force;
    return test::showWith(test::DeviceWorld({0.4f}), options, [](LiveScene& live, Shown&, Progress& progress) {
        Look look;
        for (const float yaw : {40.0f, 80.0f}) {
            look.environment.yawDegrees = yaw;
            live.setLook(look);
            while (!live.refine(1, progress)) {}
        }
    });
}

TEST(LiveDevice, ShowsTheSameImageAsTheProcessor) {
    const auto device = std::make_shared<TestDevice>();
    const Shown without = show(nullptr), with = show(device);
    EXPECT_EQ(with.radiance, without.radiance);
    EXPECT_EQ(with.report.device, "test device");
    EXPECT_GT(with.report.deviceApplyMs, 0);
    EXPECT_GT(with.report.cpuApplyMs, 0);
    EXPECT_EQ(without.report.device, "");
    EXPECT_EQ(without.report.deviceApplyMs, 0);
    EXPECT_GT(without.report.cpuApplyMs, 0);
    EXPECT_EQ(device->loads, 1) << "the store did not change";
}

TEST(LiveDevice, ADeviceThatFailsLosesNothingAndIsNotAskedAgain) {
    const Shown without = show(nullptr);
    for (int failsAt : {1, 3, 5, 6}) {
        const auto device = std::make_shared<TestDevice>();
        device->failsAt = failsAt;
        const Shown with = show(device);
        EXPECT_EQ(with.radiance, without.radiance) << failsAt;
        EXPECT_EQ(with.report.device, "") << failsAt;
        EXPECT_EQ(with.warnings, 1u) << failsAt;
        EXPECT_EQ(device->applies, failsAt);
        EXPECT_EQ(show(device).radiance, without.radiance);
        EXPECT_EQ(device->applies, failsAt) << "another scene asks it again";
    }
    const auto full = std::make_shared<TestDevice>();
    full->failsLoadAt = 1;
    EXPECT_EQ(show(full).radiance, without.radiance);
    EXPECT_EQ(full->applies, 0);
}

TEST(LiveDevice, ADeviceThatAnswersWronglyIsRefused) {
    const Shown without = show(nullptr);
    for (float factor : {1.01f, 0.0f, std::numeric_limits<float>::quiet_NaN()}) {
        const auto device = std::make_shared<TestDevice>();
        device->factor = factor;
        const Shown with = show(device);
        EXPECT_EQ(with.radiance, without.radiance);
        EXPECT_EQ(with.report.device, "");
        EXPECT_EQ(with.warnings, 1u);
    }
}

TEST(LiveDevice, TheFasterOneIsUsedUnlessForced) {
    const auto device = std::make_shared<TestDevice>();
    const Shown shown = show(device, false);
    EXPECT_EQ(shown.report.device.empty(), shown.report.deviceApplyMs >= shown.report.cpuApplyMs);
    EXPECT_EQ(shown.warnings, 0u);
}

}  // namespace
}  // namespace relamp
