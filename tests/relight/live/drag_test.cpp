// What a dragged emitter shows at once, against the light at rest in the same place.
#include <gtest/gtest.h>

#include "base/parallel.h"
#include "bench/bench_world.h"
#include "relight/live/gaze.h"
#include "relight/live/live_scene.h"
#include "support/estimates.h"

namespace relamp {
namespace {

/// Differences of display values where the eye looks, white at the 90th percentile of the image at rest: root mean
/// square and 99th percentile.
std::pair<float, float> shownDifference(const LiveFrame& image, const LiveFrame& rest, const Gaze& gaze) {
    std::vector<float> bright, off;
    const auto counts = [&](size_t v) {
        return maxChannel(rest.distantMatte[v]) > 0 && !gaze.misses(rest.mesh->positions[v], rest.mesh->normals[v]);
    };
    for (size_t v = 0; v < rest.radiance.size(); ++v)
        if (counts(v)) bright.push_back(maxChannel(rest.radiance[v]));
    std::sort(bright.begin(), bright.end());
    const float white = bright[bright.size() * 9 / 10];
    const auto display = [&](float x) { return std::pow(std::clamp(x / white, 0.0f, 1.0f), 1 / 2.2f); };
    float sum = 0;
    for (size_t v = 0; v < rest.radiance.size(); ++v)
        if (counts(v)) {
            off.push_back(std::abs(display(image.radiance[v].g) - display(rest.radiance[v].g)));
            sum += off.back() * off.back();
        }
    std::sort(off.begin(), off.end());
    return {std::sqrt(sum / float(off.size())), off[off.size() * 99 / 100]};
}

TEST(LiveDrag, ItTakesLightAtFewVerticesAndShowsNearlyTheImageAtRest) {
    const bench::World w = bench::makeWorld(9000, false);
    Progress progress;
    LiveScene live(w.scene, w.estimate, {}, progress);
    const Eye eye{{6, -6, 5}, glm::normalize(Vec3(-6, 6, -4.6f)), false, 0.5f};
    const Gaze gaze{eye.position, eye.forward, std::cos(eye.halfAngle)};
    live.setEye(eye);
    const auto atRest = [&] {
        while (!live.refine(1, progress)) {}
        return live.frame();
    };
    const std::vector<Rgb> before = atRest()->radiance;
    const auto step = [&](const Vec3& by) {
        Look look;
        look.emitters.push_back({"emitter-1", true, test::translation(by), Rgb(1)});
        live.setLook(look);
        live.refine(0, progress);
        return live.frame();
    };
    std::shared_ptr<const LiveFrame> image;
    for (const Vec3& by : {Vec3(-0.5f, -0.3f, 0), Vec3(1.5f, -1, -0.4f), Vec3(0.3f, -1.6f, -1.2f)}) {
        image = step(by);
        EXPECT_GT(image->report.lightBetween, w.vertices / 3);
        const std::shared_ptr<const LiveFrame> rest = atRest();
        const auto [rms, most] = shownDifference(*image, *rest, gaze);
        EXPECT_LT(rms, 0.018f) << by.x;
        EXPECT_LT(most, 0.07f) << by.x;
    }
    step(Vec3(-0.5f, -0.3f, 0));
    {
        const ThreadLimit one(1);
        EXPECT_EQ(step(Vec3(0.3f, -1.6f, -1.2f))->formFactor, image->formFactor);
    }
    live.setLook({});
    EXPECT_EQ(atRest()->radiance, before) << "nothing of a drag is left at rest";
}

}  // namespace
}  // namespace relamp
