#include "relight/denoise.h"

#include <gtest/gtest.h>

#include "base/parallel.h"
#include "relight/frame.h"
#include "support/estimates.h"

namespace relamp {
namespace {

FrameOptions options(bool denoise, int samples = 8) {
    FrameOptions o;
    o.denoise = denoise;
    o.samplesPerPixel = samples;
    return o;
}

Frame render(const RelitScene& relit, const Camera& camera, const FrameOptions& o) {
    Progress progress;
    return renderFrame(relit, camera, o, progress);
}

/// Root mean square difference, and the largest.
struct Difference {
    double rms = 0, most = 0;
};
Difference difference(const std::vector<Rgb>& a, const std::vector<Rgb>& b) {
    Difference d;
    for (size_t p = 0; p < a.size(); ++p) {
        const Rgb e = a[p] - b[p];
        d.rms += double(glm::dot(e, e)) / 3 / double(a.size());
        d.most = std::max(d.most, double(maxChannel(glm::abs(e))));
    }
    d.rms = std::sqrt(d.rms);
    return d;
}

Camera squareFromAbove(int side = 64) { return test::cameraAt({0, 0, 3}, {0, 0, 0}, side, side, side, {0, 1, 0}); }

/// A table with a block on it, under a bright sky and a small lamp: soft and hard shadows.
class Denoise : public testing::Test {
protected:
    static Scene scene() {
        Mesh mesh = test::sheet({-3, -3, 0}, {6, 0, 0}, {0, 6, 0}, 30, 30);
        test::append(mesh, test::sheet({-0.4f, -0.4f, 0.5f}, {0.5f, 0, 0}, {0, 0.5f, 0}, 2, 2));
        return test::sceneOf(mesh);
    }
    static RelitScene relitOf(const Scene& scene, const Estimate& estimate) {
        Look look;
        look.added.push_back(
            {EmitterShape::sphere, "lamp", test::translation({1.0f, 0.3f, 1.2f}), Vec2(0.04f), Rgb(60)});
        return test::relitOf(scene, estimate, look);
    }
    Scene scene_ = scene();
    RelitScene relit_ = relitOf(scene_, test::matteEstimate(scene_, Rgb(0.6f, 0.5f, 0.4f), Rgb(1, 1.2f, 1.5f)));
};

TEST_F(Denoise, TakesNoiseAwayAndKeepsShadows) {
    const Frame truth = render(relit_, squareFromAbove(), options(false, 128));
    const Frame noisy = render(relit_, squareFromAbove(), options(false));
    const Frame quiet = render(relit_, squareFromAbove(), options(true));
    const Difference before = difference(noisy.beauty, truth.beauty), after = difference(quiet.beauty, truth.beauty);
    EXPECT_LT(after.rms, 0.5 * before.rms);
    EXPECT_LT(after.most, before.most);
    Rgb mean(0), expected(0);
    for (size_t p = 0; p < truth.beauty.size(); ++p) mean += quiet.beauty[p], expected += truth.beauty[p];
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(mean[c] / expected[c], 1, 0.003);
}

TEST_F(Denoise, KeepsPrintsAsSharpAsTheyAre) {
    Estimate estimate = test::matteEstimate(scene_, Rgb(0.6f), Rgb(1));
    for (size_t v = 0; v < scene_.mesh.vertexCount(); ++v) {
        const Vec3& at = scene_.mesh.positions[v];
        const int squares = int(std::floor(at.x * 5 + 0.5f)) + int(std::floor(at.y * 5 + 0.5f));
        estimate.reflectance.weight[0][v] = Rgb(squares % 2 ? 0.7f : 0.1f);
    }
    const RelitScene relit = relitOf(scene_, estimate);
    const Frame truth = render(relit, squareFromAbove(), options(false, 128));
    // A pixel's few positions see a colour of their own; the light on it is compared.
    const auto light = [&](bool denoise) {
        Frame frame = render(relit, squareFromAbove(), options(denoise));
        for (size_t p = 0; p < frame.beauty.size(); ++p) frame.beauty[p] *= truth.albedo[p] / frame.albedo[p];
        return frame.beauty;
    };
    EXPECT_LT(difference(light(true), truth.beauty).rms, 0.6 * difference(light(false), truth.beauty).rms);
}

TEST_F(Denoise, GroupsStillAddUpToTheBeauty) {
    const Frame frame = render(relit_, squareFromAbove(40), options(true));
    for (size_t p = 0; p < frame.beauty.size(); ++p) {
        Rgb sum = frame.world[p];
        for (const auto& group : frame.byEmitter) sum += group[p];
        EXPECT_LT(maxChannel(glm::abs(sum - frame.beauty[p])), 1e-5f * (1 + maxChannel(sum))) << p;
    }
}

TEST_F(Denoise, LeavesEmittersAndBackgroundAlone) {
    const Camera camera = test::cameraAt({1.0, -2, 1.2}, {1.0, 0.3, 1.2}, 48, 48, 160);
    const Frame noisy = render(relit_, camera, options(false)), quiet = render(relit_, camera, options(true));
    size_t emitters = 0, background = 0;
    for (size_t p = 0; p < noisy.beauty.size(); ++p) {
        const bool emitter = noisy.emittersSeen[p][0].fraction == 1, nothing = noisy.alpha[p] == 0;
        emitters += emitter;
        background += nothing;
        if (emitter || nothing) { EXPECT_EQ(quiet.beauty[p], noisy.beauty[p]) << p; }
    }
    EXPECT_GT(emitters, 3u);
    EXPECT_GT(background, 100u);
}

TEST_F(Denoise, StripsAndThreadsGiveTheSameBits) {
    const Camera camera = squareFromAbove(70);
    const Frame whole = render(relit_, camera, options(true, 2));
    const FrameOptions o = options(true, 2);
    const FrameRenderer renderer(relit_, camera, o);
    const ThreadLimit limit(1);
    Progress progress;
    size_t at = 0;
    for (const auto& [first, count] : std::vector<std::pair<int, int>>{{0, 21}, {21, 1}, {22, 48}})
        for (const Rgb& value : renderer.rows(first, count, progress).beauty)
            ASSERT_EQ(value, whole.beauty[at++]) << at;
    EXPECT_EQ(at, whole.beauty.size());
}

TEST_F(Denoise, TheBeautyAloneIsDenoisedAsWell) {
    FrameOptions o = options(true);
    o.groups = false;
    const Frame truth = render(relit_, squareFromAbove(), options(false, 128));
    const Difference before = difference(render(relit_, squareFromAbove(), options(false)).beauty, truth.beauty);
    EXPECT_LT(difference(render(relit_, squareFromAbove(), o).beauty, truth.beauty).rms, 0.6 * before.rms);
}

}  // namespace
}  // namespace relamp
