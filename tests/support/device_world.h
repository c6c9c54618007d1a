// A small scene for tests of devices that light is computed on: a box on the ground under square emitters.
#pragma once
#include "base/log.h"
#include "relight/live/live_scene.h"
#include "support/estimates.h"

namespace relamp::test {

struct DeviceWorld {
    std::shared_ptr<const Scene> scene;
    std::shared_ptr<const Estimate> estimate;
    /// `sides` of the emitters; each hangs at its own side along x.
    explicit DeviceWorld(const std::vector<float>& sides) {
        Mesh mesh = sheet({-2, -2, 0}, {4, 0, 0}, {0, 4, 0}, 24, 24);
        append(mesh, box({-0.4f, -0.4f, 0.01f}, {0.4f, 0.4f, 0.8f}, 4));
        std::vector<std::vector<uint32_t>> patches;
        for (const float side : sides) patches.push_back(append(mesh, squareAbove(side, 0.9f, side, 2, 2)));
        scene = std::make_shared<const Scene>(sceneOf(mesh));
        estimate = std::make_shared<const Estimate>(
            matteEstimate(*scene, Rgb(0.5f, 0.4f, 0.3f), Rgb(1),
                          emittersOf(*scene, patches, std::vector<Rgb>(patches.size(), Rgb(20, 24, 30)))));
    }
};

/// What a session with a device showed.
struct DeviceShown {
    std::vector<Rgb> coarse, radiance;
    LiveReport report;
    size_t warnings = 0;
};

/// Opens the world with `options`, lets `edit` work on it, and keeps the last image.
inline DeviceShown showWith(const DeviceWorld& world, const LiveOptions& options,
                            const std::function<void(LiveScene&, DeviceShown&, Progress&)>& edit) {
    DeviceShown shown;
    setLogSink([&](LogLevel level, const std::string&) { shown.warnings += level == LogLevel::warning; });
    Progress progress;
    LiveScene live(world.scene, world.estimate, options, progress);
    edit(live, shown, progress);
    setLogSink({});
    shown.radiance = live.frame()->radiance;
    shown.report = live.frame()->report;
    return shown;
}

}  // namespace relamp::test
